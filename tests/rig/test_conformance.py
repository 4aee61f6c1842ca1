"""Every driver on its simulator, and every fake, passes the public suite."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from rig import conformance
from rig.clock import Clock, MonotonicClock
from rig.config import read_rig
from rig.devices import Camera, LightArm, Lights, Turntable
from rig.fakes import FakeArm, FakeCamera, FakeClock, FakeLights, FakeTurntable
from rig.rig import Rig, open_rig
from tests.rig.grbl.bench import QUICK

RELIEF = {"scene": {"kind": "relief"}}


@contextmanager
def simulated(kind: str, *parts: str) -> Iterator[Rig]:
    with (
        simulated_rig(SimConfig.model_validate({"scene": {"kind": kind}, "arm": {"settings": QUICK}})) as sim,
        opened(sim, *parts) as rig,
    ):
        yield rig


def opened(sim: RunningSim, *parts: str) -> Rig:
    return open_rig(read_rig(sim.rig_toml), use=frozenset(parts), environment=sim.environment)


@pytest.fixture(params=["fake", "Dynamixel"])
def turntable(request: pytest.FixtureRequest) -> Iterator[Turntable]:
    if request.param == "fake":
        yield FakeTurntable()
        return
    with simulated("brushed-sphere", "turntable") as rig:
        yield rig.turntable


@pytest.fixture(params=["fake", "GRBL"])
def arm(request: pytest.FixtureRequest) -> Iterator[LightArm]:
    if request.param == "fake":
        yield FakeArm()
        return
    with simulated("relief", "arm", "lights") as rig:
        yield rig.arm


@pytest.fixture(params=["fake", "GRBL spindle", "uDMX", "always on"])
def lights(request: pytest.FixtureRequest) -> Iterator[Lights]:
    if request.param == "fake":
        yield FakeLights()
        return
    described = {"GRBL spindle": RELIEF, "uDMX": {**RELIEF, "dome": {}}, "always on": {}}[request.param]
    with simulated_rig(SimConfig.model_validate(described)) as sim, opened(sim, "arm", "lights") as rig:
        rig.get_ready()
        yield rig.lights


@pytest.fixture(params=["fake", "V4L2"])
def camera(request: pytest.FixtureRequest) -> Iterator[tuple[Camera, Clock]]:
    if request.param == "fake":
        clock = FakeClock()
        yield FakeCamera(lambda: b"picture", clock), clock
        return
    with simulated("brushed-sphere", "camera") as rig:
        yield rig.camera, MonotonicClock()


@pytest.mark.parametrize("check", conformance.TURNTABLE, ids=lambda check: check.__name__)
def test_turntables(check: Callable[[Turntable], None], turntable: Turntable) -> None:
    check(turntable)


@pytest.mark.parametrize("check", conformance.LIGHT_ARM, ids=lambda check: check.__name__)
def test_light_arms(check: Callable[[LightArm], None], arm: LightArm) -> None:
    check(arm)


@pytest.mark.parametrize("check", conformance.LIGHTS, ids=lambda check: check.__name__)
def test_lights(check: Callable[[Lights], None], lights: Lights) -> None:
    check(lights)


@pytest.mark.parametrize("check", conformance.CAMERA, ids=lambda check: check.__name__)
def test_cameras(check: Callable[[Camera, Clock], None], camera: tuple[Camera, Clock]) -> None:
    check(*camera)


class Broken(FakeTurntable):
    """Clamps, as careless drivers do."""

    def check(self, angle_deg: float) -> None:
        self.angle_deg = max(self.min_deg, min(self.max_deg, angle_deg))


def test_the_suite_finds_a_driver_that_clamps() -> None:
    with pytest.raises(AssertionError, match="OutOfRangeError was not raised"):
        conformance.refuses_angles_out_of_range_and_stays(Broken())
