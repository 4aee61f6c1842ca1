"""The driver on a simulated servo, while a clock is turned by hand."""

from fractions import Fraction

import pytest

from firmware_sim.dynamixel.control_table import Mode, Register
from firmware_sim.dynamixel.memory import Memory
from rig.config import TurntableConfig
from rig.dynamixel import registers
from rig.dynamixel.turntable import DynamixelTurntable
from rig.errors import DeviceError, OutOfRangeError, PositionLostError
from tests.rig.dynamixel.wires import Bench

GOAL = b"\x03\x74\x00"
TICK_DEG = 360 / 4096


def goals_of(bench: Bench) -> list[int]:
    """Return the goal positions that went over the wire."""
    return [
        int.from_bytes(content[10:14], "little", signed=True)
        for _, content in bench.stream.sent
        if content[7:10] == GOAL
    ]


@pytest.mark.parametrize("slices", [3, 7, 101, 127, 128, 361])
@pytest.mark.parametrize("ratio", [1.0, 2.5, 17 / 19, 3.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_each_slice_is_counted_from_one_origin_and_rounded_once(slices: int, ratio: float, direction: int) -> None:
    table = Bench().turntable(gear_ratio=ratio, direction=direction, zero_deg=12.34)
    for s in range(slices + 1):
        exact = (Fraction(12.34) + direction * Fraction(ratio) * Fraction(360 * s, slices)) * 4096 / 360
        assert abs(table._ticks(360 * s / slices) - exact) <= Fraction(1, 2) + Fraction(1, 10**9)


def test_angles_read_back_are_those_of_the_table() -> None:
    bench = Bench()
    table = bench.turntable(gear_ratio=3.0, direction=-1, zero_deg=90.0)
    table.home()
    pose = table.move_to(40.0)
    assert bench.servo.angle_deg(bench.now_s()) == pytest.approx(90 - 120, abs=TICK_DEG)
    assert pose.angle_deg == pytest.approx(40, abs=TICK_DEG / 3)
    assert pose.commanded_deg == 40.0


@pytest.mark.parametrize(
    ("before_deg", "goals_deg"),
    [
        pytest.param(20.0, [40.0], id="from below it is already in contact"),
        pytest.param(39.5, [39.0, 40.0], id="from just below it steps back first"),
        pytest.param(70.0, [39.0, 40.0], id="from above it goes past the goal and comes back"),
    ],
)
def test_a_goal_is_approached_from_below_by_the_backlash(before_deg: float, goals_deg: list[float]) -> None:
    bench = Bench()
    table = bench.turntable(backlash_deg=1.0)
    table.home()
    table.move_to(before_deg)
    bench.stream.sent.clear()
    table.move_to(40.0)
    assert goals_of(bench) == [round(goal / TICK_DEG) for goal in goals_deg]


def test_at_the_lower_limit_the_run_up_is_as_long_as_anywhere() -> None:
    bench = Bench()
    table = bench.turntable(backlash_deg=1.0, min_deg=0.0)
    table.home()
    table.move_to(10.0)
    bench.stream.sent.clear()
    table.move_to(0.0)
    assert goals_of(bench) == [round(-1 / TICK_DEG), 0]


def test_where_it_stands_already_it_does_not_move_again() -> None:
    bench = Bench()
    table = bench.turntable()
    table.home()
    table.move_to(10.0)
    bench.stream.sent.clear()
    assert table.move_to(10.0).commanded_deg == 10.0
    assert goals_of(bench) == []
    table.stop()
    bench.stream.sent.clear()
    table.move_to(10.0)  # who knows from which side the stop came
    assert len(goals_of(bench)) == 2


def test_beyond_the_turns_that_the_servo_counts_nothing_is_sent() -> None:
    bench = Bench()
    table = bench.turntable(gear_ratio=100.0, max_deg=2000.0)
    for action in (table.check, table.move_to):
        with pytest.raises(OutOfRangeError, match="beyond the ±256 turns"):
            action(1000.0)
    assert not bench.stream.sent


def test_a_speed_beyond_the_servos_limit_is_refused() -> None:
    with pytest.raises(DeviceError, match=r"turns at 364°/s at most .* asks it for 900°/s; lower speed_deg_s to 36 or"):
        Bench().turntable(speed_deg_s=90.0, gear_ratio=10.0).home()


def test_a_profile_of_times_is_turned_into_one_of_speeds() -> None:
    bench = Bench()
    bench.servo.memory[Register.DRIVE_MODE] = 0b0101
    bench.servo.memory[Register.OPERATING_MODE] = Mode.POSITION
    table = bench.turntable()
    table.home()
    assert bench.servo.memory[Register.DRIVE_MODE] == 0b0001, "its sense of rotation is left alone"
    assert bench.servo.memory[Register.OPERATING_MODE] == Mode.EXTENDED_POSITION
    table.move_to(30.0)
    assert bench.servo.angle_deg(bench.now_s()) == pytest.approx(-30, abs=TICK_DEG)


def test_the_watchdog_watches_while_the_table_moves_and_only_then() -> None:
    bench = Bench()
    table = bench.turntable()
    table.home()
    bench.clock.after(0.5, lambda: seen.append(bench.servo.memory[Register.BUS_WATCHDOG]))
    seen: list[int] = []
    table.move_to(90.0)
    assert seen == [20]
    assert bench.servo.memory[Register.BUS_WATCHDOG] == 0
    bench.clock.sleep(100)
    assert table.locate().angle_deg == pytest.approx(90, abs=TICK_DEG)


def test_a_host_that_was_too_slow_for_the_watchdog_goes_on() -> None:
    bench = Bench()
    table = bench.turntable()
    table.home()
    bench.clock.after(0.5, lambda: setattr(bench.clock, "time_s", bench.clock.time_s + 2.0))
    assert table.move_to(300.0).angle_deg == pytest.approx(300, abs=TICK_DEG)
    assert goals_of(bench).count(round(300 / TICK_DEG)) >= 2, "the watchdog did not trip, so this tests nothing"


def test_a_watchdog_that_tripped_in_another_life_is_cleared() -> None:
    bench = Bench()
    bench.servo.memory[Register.BUS_WATCHDOG] = 255
    table = bench.turntable()
    table.home()
    assert table.move_to(20.0).angle_deg == pytest.approx(20, abs=TICK_DEG)


def test_old_firmware_has_no_watchdog_and_is_not_asked_for_one() -> None:
    bench = Bench()
    bench.servo.memory[Register.FIRMWARE_VERSION] = 37
    table = bench.turntable()
    table.home()
    table.move_to(20.0)
    table.stop()
    assert not any(content[7:10] == b"\x03\x62\x00" for _, content in bench.stream.sent)


def test_a_table_that_turns_when_it_is_homed_is_stopped_first() -> None:
    bench = Bench()
    left = bench.turntable()
    left.home()
    left._send(3000)
    bench.clock.sleep(1.0)
    table = bench.turntable()
    table.home()
    bench.clock.sleep(3.0)
    assert 30 < table.locate().angle_deg < 120


def test_torque_that_somebody_took_away_is_told_and_the_position_is_kept() -> None:
    bench, table = at_30_deg()
    bench.servo.write(64, b"\x00")
    with pytest.raises(DeviceError, match="torque was switched off, its position is kept") as caught:
        table.locate()
    assert not isinstance(caught.value, PositionLostError)
    with pytest.raises(DeviceError, match="not homed yet"):
        table.move_to(40.0)
    table.home()
    assert table.move_to(40.0).angle_deg == pytest.approx(40, abs=TICK_DEG)


def test_a_goal_from_somebody_else_is_told() -> None:
    bench, table = at_30_deg()
    bench.servo.write(116, (700).to_bytes(4, "little"))
    with pytest.raises(PositionLostError, match="has a goal that nobody here gave it"):
        table.locate()


def test_a_servo_that_keeps_its_torque_through_a_reset_is_found_out() -> None:
    bench, table = at_30_deg()
    bench.servo.memory[Register.STARTUP_CONFIGURATION] = 3
    bench.servo.brown_out(15.0)
    bench.clock.sleep(0.3)
    with pytest.raises(PositionLostError, match="it was reset, or another program talks to it"):
        table.locate()


def test_a_reset_is_mended_by_homing_and_the_angle_within_a_turn_is_right() -> None:
    bench, table = at_30_deg()
    bench.servo.brown_out(5.0)
    bench.clock.sleep(0.3)
    with pytest.raises(PositionLostError, match=r"was reset .* check the supply, then home it"):
        table.locate()
    table.home()
    assert table.locate().angle_deg == pytest.approx(35, abs=TICK_DEG)


def test_health_tells_supply_temperature_and_what_is_wrong() -> None:
    bench = Bench()
    table = bench.turntable()
    health = table.health()
    assert (health.model, health.firmware, health.torque) == ("XL430-W250", 45, False)
    assert (health.input_v, health.min_input_v, health.max_input_v) == (12.0, 6.0, 14.0)
    assert (health.temperature_deg_c, health.max_temperature_deg_c) == (34, 72)
    assert health.complaints() == []
    bench.servo.feel(volts=5.5, deg_c=80)
    complaints = table.health().complaints()
    assert "input voltage out of range, overheating" in complaints[0]
    assert "5.5 V, it wants 6.0 to 14.0 V; check the power supply" in complaints[1]
    assert "80 °C, its limit is 72 °C; let it cool" in complaints[2]


def test_a_tolerance_below_the_servos_steps_is_refused() -> None:
    with pytest.raises(ValueError, match="must reach half a step of the servo"):
        TurntableConfig(port="x", tolerance_deg=0.02)
    assert TurntableConfig(port="x", tolerance_deg=0.02, gear_ratio=4.0).tolerance_deg == 0.02


def test_blocks_are_told_from_each_other_and_from_registers_by_their_length() -> None:
    sizes = [registers.EEPROM.size, registers.STATE.size, registers.MOTION.size]
    assert len(set(sizes)) == 3
    assert min(sizes) > 4
    assert len(Memory().read(registers.STATE.address, registers.STATE.size)) == registers.STATE.size


def at_30_deg() -> tuple[Bench, DynamixelTurntable]:
    bench = Bench()
    table = bench.turntable()
    table.home()
    table.move_to(30.0)
    return bench, table
