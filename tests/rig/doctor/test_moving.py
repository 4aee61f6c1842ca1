"""What motion shows, on devices in memory."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
import pytest

from rig.config import RigConfig
from rig.devices import ArmPose
from rig.doctor import moving
from rig.doctor.finding import Finding, State
from rig.errors import DeviceError
from rig.fakes import FakeArm, FakeCamera, FakeClock, FakeLights, FakeTurntable
from rig.rig import Rig

SECTIONS = {
    "turntable": {"port": "/dev/ttyA", "min_deg": -30.0, "max_deg": 60.0},
    "arm": {"port": "/dev/ttyB"},
    "lights": {"kind": "grbl-spindle"},
    "camera": {"device": "/dev/video97"},
}


@dataclass
class Devices:
    """One rig in memory, with what it was opened for."""

    turntable: FakeTurntable = field(default_factory=lambda: FakeTurntable(-30.0, 60.0))
    arm: FakeArm = field(default_factory=FakeArm)
    lights: FakeLights = field(default_factory=FakeLights)
    lit: float = 120.0
    opened: list[frozenset[str]] = field(default_factory=list)
    frames: int = 0

    def open(self, config: RigConfig, *, use: frozenset[str], environment: object) -> Rig:
        self.opened.append(use)
        clock = FakeClock()
        return Rig(
            config,
            clock=clock,
            turntable=self.turntable if "turntable" in use else None,
            arm=self.arm if "arm" in use and config.arm is not None else None,
            lights=self.lights if "lights" in use else None,
            camera=FakeCamera(self.paint, clock) if "camera" in use else None,
        )

    def paint(self) -> bytes:
        self.frames += 1
        level = 10 + self.frames % 2 + (self.lit if self.lights.lamp is not None else 0)
        return cv2.imencode(".jpg", np.full((48, 64, 3), level, np.uint8))[1].tobytes()


@pytest.fixture
def devices(monkeypatch: pytest.MonkeyPatch) -> Devices:
    made = Devices()
    monkeypatch.setattr(moving, "open_rig", made.open)
    return made


def examined(*parts: str, **changes: Any) -> dict[tuple[str, str], Finding]:
    config = RigConfig.model_validate({part: SECTIONS[part] for part in parts or SECTIONS} | changes)
    return {(finding.part, finding.name): finding for finding in moving.examine_moving(config)}


def test_a_healthy_rig_goes_everywhere_and_comes_to_rest(devices: Devices) -> None:
    found = examined()
    assert {finding.state for finding in found.values()} == {State.OK}
    assert found["turntable", "travel"].what == "went to -30° and 60°"
    assert found["arm", "travel"].what == "went to azimuth 0° to 270°, elevation 6° to 88°"
    assert found["lights", "effect"].what == "lamps that change the picture: 1 of 1"
    assert not devices.turntable.torque, "it is let go at the end"
    assert devices.lights.lamp is None, "and dark"


def test_each_part_is_moved_with_nothing_else_open(devices: Devices) -> None:
    examined()
    assert devices.opened == [{"turntable"}, {"arm", "lights"}, {"arm", "lights", "camera"}]


def test_parts_that_a_rig_does_not_have_are_not_moved(devices: Devices) -> None:
    assert {part for part, _ in examined("turntable", "camera")} == {"turntable"}


def test_a_lamp_that_does_not_change_the_picture_is_a_fault(devices: Devices) -> None:
    devices.lit = 0.0
    finding = examined()["lights", "effect"]
    assert finding.state is State.FAULT
    assert finding.what == "lamp 0 does not change the picture"


def test_lamps_that_nobody_switches_are_not_tried(devices: Devices) -> None:
    finding = examined("camera", lights={"kind": "always-on"})["lights", "effect"]
    assert (finding.state, devices.frames) == (State.OK, 0)


def test_a_table_that_arrives_elsewhere_is_a_fault(devices: Devices) -> None:
    devices.turntable.error_deg = 0.7
    finding = examined("turntable")["turntable", "arrival"]
    assert finding.state is State.FAULT
    assert "0.70° off" in finding.what


def test_an_arm_that_arrives_elsewhere_is_a_fault(devices: Devices, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices.arm, "move_to", lambda azimuth, elevation: ArmPose(azimuth + 3, elevation))
    assert examined("arm", "lights")["arm", "arrival"].state is State.FAULT


def test_an_error_of_one_part_stops_it_and_the_next_is_tried(devices: Devices, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(angle_deg: float) -> None:
        raise DeviceError("turntable: stands still; look what blocks it")

    monkeypatch.setattr(devices.turntable, "move_to", fail)
    found = examined()
    assert found["turntable", "motion"].next_step == "look what blocks it"
    assert devices.turntable.stops == 1, "it holds"
    assert found["arm", "travel"].state is State.OK


def test_an_interrupt_stops_what_moves(devices: Devices, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupt: Callable[[float], None] = lambda _: (_ for _ in ()).throw(KeyboardInterrupt)  # noqa: E731
    monkeypatch.setattr(devices.turntable, "move_to", interrupt)
    with pytest.raises(KeyboardInterrupt):
        examined()
    assert devices.turntable.stops == 1
