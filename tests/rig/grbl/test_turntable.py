"""A stepper table on a GRBL axis: its zero, its limits, and what it refuses to do unasked."""

from collections.abc import Callable
from typing import Any

import pytest

from firmware_sim.grbl.dialect import DialectName
from rig import conformance
from rig.devices import Turntable
from rig.errors import DeviceError, OutOfRangeError, PositionLostError
from tests.rig.grbl.bench import Bench

FREE = {20: 0.0, 22: 0.0}
"""No soft limits and no homing: the table turns for ever."""
SWITCHED = {100: 50.0, 130: 1080.0, 44: 1.0, 45: 0.0, 46: 0.0, 47: 0.0}
"""X has a switch at the upper end of three turns."""
TO_SWITCH: dict[str, Any] = {"axis": "X", "zero": "switch", "origin_deg": -720.0}


def standing() -> Turntable:
    return Bench(settings=FREE).turntable(axis="Z")


def switched() -> Turntable:
    return Bench(settings=SWITCHED, start=(-500.0, -1.0, -1.0)).turntable(**TO_SWITCH)


def beside_the_arm(dialect: DialectName = "grblHAL") -> Turntable:
    bench = Bench(dialect=dialect, axes=4)
    controller = bench.controller()
    bench.arm(controller).home()
    return bench.turntable(controller, owns=False, axis="A")


KINDS: dict[str, Callable[[], Turntable]] = {
    "where it stood": standing,
    "from a switch": switched,
    "on the arm's controller, grblHAL": beside_the_arm,
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("check", conformance.TURNTABLE, ids=lambda check: check.__name__)
def test_it_passes_the_public_suite(check: Callable[[Turntable], None], kind: str) -> None:
    check(KINDS[kind]())


def test_zero_is_where_it_stood_and_no_second_program_moves_it() -> None:
    bench = Bench(settings=FREE)
    first = bench.turntable(axis="X")
    first.home()
    first.move_to(30.0)
    first.close()
    second = bench.turntable(axis="X")
    second.home()
    assert second.locate().angle_deg == pytest.approx(30, abs=0.01)
    moved = len(bench.port.written)
    second.move_to(30.0)
    assert bench.true_place()[0] - -60.0 == pytest.approx(30, abs=0.01)
    assert len(bench.port.written) > moved


def test_slices_of_a_turn_are_rounded_once_and_never_accumulate() -> None:
    bench = Bench(settings=FREE | {100: 88.889})
    table = bench.turntable(axis="X", backlash_deg=0)
    table.home()
    for number in range(0, 361, 60):
        pose = table.move_to(360 * number / 361)
        assert abs(pose.angle_deg - 360 * number / 361) < 0.5 / 88.889 + 0.0006


def test_every_goal_is_approached_from_below() -> None:
    bench = Bench(settings=FREE)
    table = bench.turntable(axis="X", backlash_deg=2)
    table.home()
    table.move_to(20)
    bench.port.written.clear()
    table.move_to(10)
    goals = [part.split(b"F")[0] for _, part in bench.port.written if b"G53" in part]
    assert goals == [b"G21G90G94G53G1X8.0000", b"G21G90G94G53G1X10.0000"]


def test_steps_are_checked_against_those_of_rig_toml() -> None:
    bench = Bench(settings=FREE)
    with pytest.raises(DeviceError, match=r"\$100 = 100 steps a degree, RIG\.toml says 88\.889; mend one of them"):
        bench.turntable(axis="X", steps_per_deg=88.889).home()
    bench.turntable(axis="X", steps_per_deg=100).home()


def test_steps_too_coarse_for_the_tolerance_are_refused() -> None:
    with pytest.raises(DeviceError, match=r"cannot stand within 0\.1° of every angle"):
        Bench(settings=FREE | {100: 2.0}).turntable(axis="X").home()


def test_an_axis_that_does_not_exist_is_named() -> None:
    with pytest.raises(DeviceError, match=r"has no axis A, only X, Y, Z; mend the axis in RIG\.toml"):
        Bench(settings=FREE).turntable(axis="A").home()


def test_soft_limits_narrower_than_rig_toml_are_refused_before_anything_moves() -> None:
    bench = Bench(settings=SWITCHED, start=(-500.0, -1.0, -1.0))
    table = bench.turntable(axis="X", zero="switch")
    with pytest.raises(DeviceError, match=r"go -360\.\.720, the controller's soft limits only -1080\.\.0"):
        table.home()
    assert bench.true_place()[0] == -500


def test_goals_out_of_range_send_no_byte() -> None:
    bench = Bench(settings=FREE)
    table = bench.turntable(axis="X", max_deg=90)
    table.home()
    bench.port.written.clear()
    with pytest.raises(OutOfRangeError):
        table.move_to(90.1)
    assert bench.port.sent() == b""


@pytest.mark.parametrize("keys", [{"axis": "X"}, TO_SWITCH], ids=["where it stood", "from a switch"])
def test_a_lost_position_is_never_taken_for_known_again_by_itself(keys: dict[str, Any]) -> None:
    stands = "zero" not in keys
    bench = Bench(settings=FREE if stands else SWITCHED, start=(-500.0, -1.0, -1.0))
    table = bench.turntable(**keys)
    table.home()
    bench.sim.lose_power(0.2)
    with pytest.raises(PositionLostError, match="restarted by itself"):
        table.move_to(30)
        bench.clock.sleep(1)
        table.move_to(40)
    for _ in range(2):
        with pytest.raises(DeviceError, match=r"not homed|position is lost|not known"):
            table.move_to(50)
    if stands:
        with pytest.raises(PositionLostError, match="turn it to its zero mark"):
            table.home()
    else:
        table.home()
        assert table.move_to(50).angle_deg == pytest.approx(50, abs=0.05)


def test_an_alarm_at_the_start_is_for_a_person_to_clear() -> None:
    bench = Bench()
    with pytest.raises(PositionLostError, match=r"switch the controller off and on .\$22=0"):
        bench.turntable(axis="Z", min_deg=-10, max_deg=0).home()
    assert b"$X" not in bench.port.sent()
    assert b"$H" not in bench.port.sent()


def test_only_a_table_that_a_switch_finds_again_is_let_go() -> None:
    for settings, keys, asleep in ((FREE, {"axis": "X"}, False), (SWITCHED, TO_SWITCH, True)):
        bench = Bench(settings=settings, start=(-500.0, -1.0, -1.0))
        table = bench.turntable(**keys)
        table.home()
        table.release()
        assert (bench.sim.state == "Sleep") is asleep
        table.home()
        table.move_to(1)


def test_the_arms_motors_are_never_switched_off_for_the_table() -> None:
    bench = Bench(dialect="grblHAL", axes=4)
    controller = bench.controller()
    bench.arm(controller).home()
    table = bench.turntable(controller, owns=False, axis="A")
    table.home()
    table.release()
    assert bench.sim.state == "Idle"
