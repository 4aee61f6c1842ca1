"""PTM sessions under the lamps of a dome."""

from pathlib import Path

import numpy as np
import pytest

from acquisition.plans import ptm_plan
from acquisition.runner import check_plan, run
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import read_journal
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.directions import direction_from_angles
from rig.config import AlwaysOnConfig, RigConfig
from rig.errors import OutOfRangeError, RigError
from rig.fakes import FakeCamera, FakeClock, FakeLights
from rig.rig import Rig
from rig.udmx.config import UdmxConfig, UdmxLamp
from tests.acquisition.test_session import picture

ANGLES = tuple((37.0 * i % 360, 20.0 + 5 * i) for i in range(12))


def rig_of(angles: tuple[tuple[float, float], ...]) -> tuple[Rig, FakeLights]:
    lamps = tuple(UdmxLamp(channels=(i + 1,), azimuth_deg=a, elevation_deg=e) for i, (a, e) in enumerate(angles))
    lights, clock = FakeLights(lamps=len(angles)), FakeClock()
    config = RigConfig(lights=UdmxConfig(kind="udmx", lamp=lamps))
    return Rig(config, clock=clock, lights=lights, camera=FakeCamera(picture, clock)), lights


def test_every_lamp_lights_its_frame_and_gives_it_its_direction(tmp_path: Path) -> None:
    rig, lights = rig_of(ANGLES)
    lit: list[int | None] = []

    def watch() -> bytes:
        lit.append(lights.lamp)
        return picture(0 if lights.lamp is None else 90)

    assert isinstance(rig.camera, FakeCamera)
    rig.camera.paint = watch
    plan = ptm_plan(12, rig.config)
    with CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer, rig:
        check_plan(plan, rig)
        list(run(plan, rig, writer, lambda: False))
    assert lit == [None, *range(12)], "the room is looked at in the dark first"
    assert lights.lamp is None
    frames = [entry for entry in read_journal(tmp_path / "s" / layout.JOURNAL) if entry["ev"] == "frame"]
    expected = [direction_from_angles(*angles) for angles in ANGLES]
    np.testing.assert_allclose([frame["light"] for frame in frames], expected, atol=1e-6)
    assert [frame["pose_goal"]["lamp"] for frame in frames] == list(range(12))


def test_a_plan_for_another_dome_is_refused_before_anything_is_lit() -> None:
    rig, lights = rig_of(ANGLES)
    turned = tuple((azimuth_deg + 1, elevation_deg) for azimuth_deg, elevation_deg in ANGLES)
    with pytest.raises(OutOfRangeError, match="lamp 0 hangs at azimuth 0°, elevation 20°, not at 1°, 20°"):
        check_plan(ptm_plan(12, rig_of(turned)[0].config), rig)
    assert lights.lamp is None


def test_lamps_without_arm_or_directions_cannot_shoot_a_ptm() -> None:
    config = RigConfig(lights=AlwaysOnConfig(kind="always-on"))
    rig = Rig(config, clock=FakeClock(), lights=FakeLights(), camera=FakeCamera(picture))
    with pytest.raises(RigError, match=r"no arm, and its lamps have no directions; add \[arm\]"):
        check_plan(ptm_plan(6), rig)


@pytest.mark.parametrize(("azimuth_deg", "elevation_deg"), ANGLES)
def test_a_lamp_is_nearest_to_its_own_direction(azimuth_deg: float, elevation_deg: float) -> None:
    rig, _ = rig_of(ANGLES)
    nearby = direction_from_angles(azimuth_deg + 2, elevation_deg - 1)
    assert rig.nearest_lamp(3 * nearby) == ANGLES.index((azimuth_deg, elevation_deg))
