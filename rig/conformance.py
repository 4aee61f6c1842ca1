"""What every driver must do, as checks that anybody can run on theirs.

Each check takes a fresh device and raises AssertionError where it misbehaves; they need no test framework. The device
must stand on hardware or a simulator that may move. With pytest:

    @pytest.mark.parametrize("check", conformance.TURNTABLE, ids=lambda check: check.__name__)
    def test_my_turntable(check, my_turntable):
        check(my_turntable)
"""

# Asserting is what these functions are for.
# ruff: noqa: S101

import math
from collections.abc import Callable

from litrig.base.directions import angle_between_deg, direction_from_angles
from rig.clock import Clock
from rig.devices import Camera, LightArm, Lights, Turntable
from rig.errors import DeviceError, OutOfRangeError

CLOSE_DEG = 0.5


def reads_back_what_it_was_told(turntable: Turntable) -> None:
    """Go both ways, and read the pose."""
    turntable.home()
    for angle_deg in (30.0, 12.5, -20.0):
        pose = turntable.move_to(angle_deg)
        assert pose.commanded_deg == angle_deg
        assert abs(pose.angle_deg - angle_deg) < CLOSE_DEG
        assert abs(turntable.locate().angle_deg - pose.angle_deg) < CLOSE_DEG


def refuses_angles_out_of_range_and_stays(turntable: Turntable) -> None:
    """Raise, and move nothing."""
    turntable.home()
    before = turntable.locate()
    for angle_deg in (1e6, -1e6, math.nan, math.inf):
        for action in (turntable.check, turntable.move_to):
            assert_raises(OutOfRangeError, action, angle_deg)
    assert abs(turntable.locate().angle_deg - before.angle_deg) < CLOSE_DEG


def does_not_move_before_it_is_homed(turntable: Turntable) -> None:
    """Raise until `home` was called."""
    assert_raises(DeviceError, turntable.move_to, 10.0)


def turntable_stops_at_any_time_and_twice(turntable: Turntable) -> None:
    """Stop idle, and stop again."""
    turntable.stop()
    turntable.home()
    turntable.stop()
    turntable.stop()
    assert abs(turntable.move_to(5.0).angle_deg - 5.0) < CLOSE_DEG


def must_be_homed_again_after_release(turntable: Turntable) -> None:
    """Let go, and refuse to move."""
    turntable.home()
    turntable.release()
    assert_raises(DeviceError, turntable.move_to, 10.0)


def brings_the_lamp_where_it_was_told(arm: LightArm) -> None:
    """Go to some directions, and read the pose."""
    arm.home()
    for azimuth_deg, elevation_deg in ((40.0, 50.0), (200.0, 30.0), (359.0, 70.0)):
        pose = arm.move_to(azimuth_deg, elevation_deg)
        wanted = direction_from_angles(azimuth_deg, elevation_deg)
        found = direction_from_angles(pose.azimuth_deg, pose.elevation_deg)
        assert angle_between_deg(wanted, found) < CLOSE_DEG


def refuses_directions_out_of_reach_and_stays(arm: LightArm) -> None:
    """Raise, and move nothing."""
    arm.home()
    before = arm.locate()
    for direction in ((0.0, -30.0), (0.0, math.nan), (math.nan, 45.0)):
        for action in (arm.check, arm.move_to):
            assert_raises(OutOfRangeError, action, *direction)
    assert abs(arm.locate().elevation_deg - before.elevation_deg) < CLOSE_DEG


def arm_does_not_move_before_it_is_homed(arm: LightArm) -> None:
    """Raise until `home` was called."""
    assert_raises(DeviceError, arm.move_to, 40.0, 50.0)


def arm_stops_at_any_time_and_keeps_its_position(arm: LightArm) -> None:
    """Stop idle, stop again, and go on without homing."""
    arm.home()
    arm.move_to(40.0, 50.0)
    arm.stop()
    arm.stop()
    arm.move_to(60.0, 50.0)


def switches_on_and_off_at_any_time_and_twice(lights: Lights) -> None:
    """Switch in every order, and refuse a lamp that does not exist."""
    lights.switch_off()
    lights.switch_on()
    lights.switch_on()
    lights.switch_off()
    lights.switch_off()
    for action in (lights.check, lights.switch_on):
        assert_raises(OutOfRangeError, action, 1000)


def exposes_after_the_instant_asked_for(camera: Camera, clock: Clock) -> None:
    """Deliver no picture from before it was asked, however long nobody asked."""
    camera.configure()
    for pause_s in (0.0, 0.2, 0.0):
        clock.sleep(pause_s)
        asked_s = clock.now_s()
        shot = camera.capture(asked_s)
        assert shot.exposed_from_s >= asked_s
        assert shot.exposed_to_s > shot.exposed_from_s
        assert shot.content


TURNTABLE: tuple[Callable[[Turntable], None], ...] = (
    reads_back_what_it_was_told,
    refuses_angles_out_of_range_and_stays,
    does_not_move_before_it_is_homed,
    turntable_stops_at_any_time_and_twice,
    must_be_homed_again_after_release,
)
LIGHT_ARM: tuple[Callable[[LightArm], None], ...] = (
    brings_the_lamp_where_it_was_told,
    refuses_directions_out_of_reach_and_stays,
    arm_does_not_move_before_it_is_homed,
    arm_stops_at_any_time_and_keeps_its_position,
)
LIGHTS: tuple[Callable[[Lights], None], ...] = (switches_on_and_off_at_any_time_and_twice,)
CAMERA: tuple[Callable[[Camera, Clock], None], ...] = (exposes_after_the_instant_asked_for,)


def assert_raises(kind: type[Exception], action: Callable[..., object], *arguments: float) -> None:
    """Fail unless the action raises an error of this kind."""
    try:
        action(*arguments)
    except kind:
        return
    raise AssertionError(f"{kind.__name__} was not raised")
