"""The light arm on a simulated controller: where its lamp comes from, and where the arm never goes."""

from collections.abc import Callable
from typing import Any

import pytest

from rig import conformance
from rig.devices import LightArm, Lights
from rig.errors import DeviceError, OutOfRangeError, PositionLostError
from tests.rig.grbl.bench import Bench

CAMERA_POST = {"name": "camera post", "azimuth_deg": (80, 100), "elevation_deg": (20, 60)}


def homed_arm(bench: Bench, **keys: Any) -> LightArm:
    arm = bench.arm(**keys)
    arm.home()
    return arm


@pytest.mark.parametrize("dialect", ["grbl", "grblHAL"])
@pytest.mark.parametrize("check", conformance.LIGHT_ARM, ids=lambda check: check.__name__)
def test_it_passes_the_public_suite(check: Callable[[LightArm], None], dialect: Any) -> None:
    check(Bench(dialect=dialect).arm())


@pytest.mark.parametrize("settings", [{}, {32: 1}], ids=["spindle", "laser"])
@pytest.mark.parametrize("check", conformance.LIGHTS, ids=lambda check: check.__name__)
def test_its_lamp_passes_the_public_suite(check: Callable[[Lights], None], settings: dict[int, float]) -> None:
    bench = Bench(settings=settings)
    controller = bench.controller()
    bench.arm(controller).home()
    check(bench.lamp(controller))


def test_a_goal_out_of_range_sends_no_byte() -> None:
    bench = Bench()
    arm = homed_arm(bench, zones=[CAMERA_POST])
    bench.port.written.clear()
    for direction, where in (((0.0, 89.0), "outside its reach"), ((90.0, 40.0), "in the zone 'camera post'")):
        with pytest.raises(OutOfRangeError, match=where):
            arm.move_to(*direction)
    assert bench.port.sent() == b""


def test_the_arm_never_enters_a_zone_between_any_two_goals() -> None:
    bench = Bench()
    arm = homed_arm(bench, zones=[CAMERA_POST])
    for azimuth, elevation in ((70, 30), (110, 50), (75, 70), (105, 15), (70, 45), (200, 25)):
        began_s = bench.clock.time_s
        arm.move_to(azimuth, elevation)
        steps = int((bench.clock.time_s - began_s) / 0.01)
        for number in range(steps):
            x, y, _ = bench.sim.position(began_s + 0.01 * number)
            assert not (80 < x + 360 < 100 and 20 < y + 90 < 60)


def test_a_lamp_on_a_raised_joint_shines_from_where_it_was_told() -> None:
    bench = Bench()
    arm = homed_arm(bench, radius_mm=400, pivot_height_mm=60)
    pose = arm.move_to(40, 50)
    assert (pose.azimuth_deg, pose.elevation_deg) == pytest.approx((40, 50), abs=0.02)
    assert bench.true_place()[1] + 90 < 45


def test_soft_limits_narrower_than_rig_toml_are_refused_before_anything_moves() -> None:
    bench = Bench(settings={130: 300})
    before = bench.true_place()
    with pytest.raises(DeviceError, match=r"axis X go -360\.\.0, the controller's soft limits only -300\.\.0 .\$130"):
        bench.arm().home()
    assert bench.true_place() == before


def test_a_slow_controller_is_waited_for() -> None:
    bench = Bench(settings={110: 600})
    arm = homed_arm(bench, max_azimuth_deg=360)
    arm.move_to(100, 40)
    assert bench.true_place()[0] == pytest.approx(-260)


def test_a_blocked_arm_is_found_out_by_the_limit_switch_or_the_next_homing_only() -> None:
    """An open loop: nothing but a switch sees lost steps, which is why frames are checked too."""
    bench = Bench(settings={21: 1, 27: 5})
    arm = homed_arm(bench)
    arm.move_to(200, 40)
    bench.sim.lose_steps("X", -20)
    with pytest.raises(PositionLostError, match="alarm 1"):
        arm.move_to(350, 40)
    with pytest.raises(DeviceError, match="not homed"):
        arm.move_to(10, 40)
    arm.stop()
    arm.home()
    arm.move_to(200, 40)
    assert bench.true_place()[:2] == pytest.approx((-160, -50))


def test_a_stop_in_the_middle_of_a_way_is_on_the_wire_at_once() -> None:
    bench = Bench()
    arm = homed_arm(bench)
    bench.clock.sleep(1)
    asked_s = bench.clock.time_s
    arm.stop()
    held_s = next(time_s for time_s, part in bench.port.written if time_s >= asked_s and part == b"!")
    assert held_s == asked_s


def test_a_stop_while_homing_resets_within_half_a_second() -> None:
    bench = Bench(settings={25: 100, 24: 50})
    arm = bench.arm()
    bench.wire.feed(b"$H\n")
    bench.clock.sleep(0.5)
    asked_s = bench.clock.time_s
    arm.stop()
    with pytest.raises(DeviceError, match="not homed"):
        arm.move_to(10, 40)
    assert next(time_s for time_s, part in bench.port.written if part == b"\x18") - asked_s <= 0.5
    assert bench.sim.state == "Alarm"
