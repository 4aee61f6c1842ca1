"""The conversation with a controller that obeys, and with one that does not; time costs nothing."""

import pytest

from firmware_sim.grbl.config import GrblFaults
from rig.errors import DeviceError, GarbledReplyError, LinkTimeoutError, PositionLostError
from rig.grbl.commands import Dwell, Jog, Move
from rig.grbl.controller import GrblController
from rig.grbl.errors import RefusedError
from rig.grbl.settings import ensure_settings
from tests.rig.grbl.bench import Bench


def homed(bench: Bench) -> GrblController:
    controller = bench.controller()
    controller.home(60)
    return controller


def test_an_ok_comes_before_the_motion_ends_and_a_drained_planner_after_it() -> None:
    bench = Bench()
    controller = homed(bench)
    controller.command(Move({"X": -100}, 100))
    assert controller.status().state == "Run"
    controller.finish_motion(10)
    assert controller.status().state == "Idle"
    assert controller.position()[0] == -100


def test_the_work_offset_is_remembered_between_reports() -> None:
    bench = Bench(settings={10: 2})
    controller = homed(bench)
    bench.wire.feed(b"G10 L2 P1 X-100\n")
    places = {controller.position() for _ in range(25)}
    assert places == {(-1.0, -1.0, -1.0)}


@pytest.mark.parametrize("dialect", ["grbl", "grblHAL"])
def test_a_stop_keeps_the_position_and_the_next_move_starts_from_there(dialect: str) -> None:
    bench = Bench(dialect="grblHAL" if dialect == "grblHAL" else "grbl")
    controller = homed(bench)
    controller.command(Move({"X": -300}, 100))
    bench.clock.sleep(1)
    controller.halt()
    assert controller.homed
    stopped = controller.position()
    assert -200 < stopped[0] < -50
    assert stopped == pytest.approx(bench.true_place(), abs=0.006)
    controller.command(Move({"X": -300}, 100))
    controller.finish_motion(10)
    assert controller.position()[0] == -300


def test_a_hold_is_resumed() -> None:
    bench = Bench()
    controller = homed(bench)
    controller.command(Move({"X": -100}, 100))
    controller.hold()
    bench.clock.sleep(0.5)
    assert (controller.status().state, controller.status().phase) == ("Hold", 0)
    with pytest.raises(DeviceError, match="somebody holds it; see why"):
        controller.finish_motion(10)
    controller.resume()
    controller.finish_motion(10)
    assert controller.position()[0] == -100


def test_a_jog_is_cancelled_without_a_reset() -> None:
    bench = Bench()
    controller = homed(bench)
    controller.command(Jog({"X": -300}, 50))
    bench.clock.sleep(1)
    controller.cancel_jog()
    bench.clock.sleep(0.5)
    assert controller.status().state == "Idle"
    assert -80 < controller.position()[0] < -30
    assert b"\x18" not in bench.port.sent()


def test_a_goal_beyond_the_soft_limits_keeps_the_position_and_needs_no_homing() -> None:
    bench = Bench()
    controller = homed(bench)
    with pytest.raises(DeviceError, match=r"alarm 2 .*its position is kept, stop it"):
        controller.command(Move({"X": -400}, 100))
    bench.clock.sleep(0.01)
    with pytest.raises(DeviceError, match="locked after an alarm that kept its position"):
        controller.command(Move({"X": -40}, 100))
    sent = len(bench.port.written)
    controller.halt()
    resets = [part for _, part in bench.port.written[sent:] if part == b"\x18"]
    assert len(resets) == 2, "a reset so soon after the alarm is not heard"
    assert controller.homed
    controller.command(Move({"X": -40}, 100))
    controller.finish_motion(10)
    assert controller.position()[0] == -40 == pytest.approx(bench.true_place()[0], abs=0.006)


def test_a_hard_limit_in_motion_loses_the_position() -> None:
    bench = Bench(settings={21: 1})
    controller = homed(bench)
    controller.command(Move({"X": -300}, 100))
    bench.clock.sleep(0.5)
    bench.sim.break_switches("stuck")
    with pytest.raises(PositionLostError, match=r"alarm 1 .*a hard limit was hit.*its position is lost, home it"):
        controller.finish_motion(10)
    assert (controller.homed, controller.lost) == (False, True)
    bench.sim.break_switches("none")
    controller.halt()
    assert controller.status().state == "Alarm", "nothing is unlocked unasked"
    controller.home(60)
    assert not controller.lost


def test_a_reset_by_somebody_else_is_noticed() -> None:
    bench = Bench()
    controller = homed(bench)
    bench.clock.sleep(1)
    bench.port._said += bench.wire.feed(b"\x18")
    with pytest.raises(PositionLostError, match="restarted by itself"):
        controller.command(Move({"X": -40}, 100))


def test_a_power_failure_is_noticed_at_the_next_question() -> None:
    bench = Bench(settings={22: 0, 20: 0})
    controller = bench.controller()
    bench.sim.lose_power(0.3)
    bench.clock.sleep(1)
    with pytest.raises(PositionLostError, match="restarted by itself; check its supply"):
        controller.position()
    assert controller.lost


@pytest.mark.parametrize("fault", ["stuck", "dead"])
def test_homing_that_fails_says_what_is_wrong_with_the_switch(fault: str) -> None:
    bench = Bench()
    bench.sim.break_switches("stuck" if fault == "stuck" else "dead")
    words = "could not clear" if fault == "stuck" else "did not find"
    with pytest.raises(PositionLostError, match=f"homing {words} the limit switch"):
        homed(bench)


def test_a_refused_line_is_told_in_words() -> None:
    bench = Bench()
    controller = bench.controller()
    with pytest.raises(RefusedError, match=r"G53G1X-40.* error 9 \(locked after an alarm\)"):
        controller.command(Move({"X": -40}, 100))


# A bad cable


@pytest.mark.parametrize("place", range(42))
def test_a_lost_byte_at_any_place_of_a_move_never_leaves_it_elsewhere(place: int) -> None:
    bench = Bench()
    arm = bench.arm()
    arm.home()
    bench.wire.drop_heard(place)
    arm.move_to(100, 40)
    assert bench.true_place()[:2] == pytest.approx((-260, -50), abs=0.01)
    assert bench.port.sent().count(b"G53G1") <= 2


@pytest.mark.parametrize("lines", [1, 2])
def test_lost_answers_are_asked_for_again(lines: int) -> None:
    bench = Bench()
    controller = homed(bench)
    bench.wire.mute = lines
    controller.command(Move({"X": -40}, 100))
    controller.finish_motion(10)
    bench.wire.mute = lines
    assert controller.position()[0] == -40


def test_damaged_answers_are_asked_for_again_and_never_believed() -> None:
    bench = Bench()
    controller = homed(bench)
    for bit in range(0, 400, 7):
        bench.wire.garble, bench.wire.bit = 1, bit
        assert controller.position() == (-1, -1, -1)


def test_late_answers_are_nobodys() -> None:
    bench = Bench()
    controller = homed(bench)
    for number, late_s in enumerate((0.3, 0.9, 1.05, 1.2, 1.5)):
        bench.wire.delay, bench.wire.delay_s = 1, late_s
        controller.command(Move({"X": -20.0 - number}, 100))
        controller.finish_motion(10)
        assert controller.position()[0] == -20 - number


def test_silence_is_an_error_that_says_what_to_check() -> None:
    bench = Bench()
    controller = homed(bench)
    bench.wire.mute = 1000
    with pytest.raises(LinkTimeoutError, match=r"no answer to G4P0\.000; check power and cable"):
        controller.command(Dwell())


def test_an_unplugged_cable_is_an_error_at_once() -> None:
    bench = Bench()
    controller = homed(bench)
    bench.port.unplugged = True
    with pytest.raises(LinkTimeoutError, match="the port went away"):
        controller.position()


def test_noise_without_end_is_an_error() -> None:
    bench = Bench()
    controller = homed(bench)
    bench.wire.garble = 10_000
    with pytest.raises(GarbledReplyError):
        for _ in range(100):
            controller.position()


def test_a_bad_cable_yields_no_wrong_place_in_many_moves() -> None:
    bench = Bench(faults=GrblFaults(mute=0.03, garble=0.03, delay=0.03, delay_s=0.7))
    arm = bench.arm()
    failed = 0
    for number in range(25):
        goal = (number * 37 % 360, 20 + number % 50)
        try:
            arm.home() if not arm._is_homed() else None
            pose = arm.move_to(*goal)
        except (DeviceError, LinkTimeoutError, GarbledReplyError):
            failed += 1
            continue
        assert (pose.azimuth_deg, pose.elevation_deg) == pytest.approx(goal, abs=0.02)
        x, y, _ = bench.true_place()
        assert (x % 360, y) == pytest.approx((goal[0], goal[1] - 90), abs=0.02)
    assert failed < 8


# Settings


def test_settings_that_differ_are_written_once_and_before_any_reset() -> None:
    bench = Bench(dialect="grblHAL")
    controller = bench.controller()
    ensure_settings(controller, {130: 400, 110: 7200})
    assert controller.settings()[130] == 400
    assert bench.port.sent().count(b"$1") == 1
    controller.reset()
    ensure_settings(controller, {130: 400})
    with pytest.raises(DeviceError, match=r"\$130 cannot be changed after a reset; switch it off and on"):
        ensure_settings(controller, {130: 360})


def test_a_setting_that_the_controller_has_not_is_refused() -> None:
    with pytest.raises(DeviceError, match=r"\$399=1\.000: error 3"):
        ensure_settings(Bench().controller(), {399: 1})


# What an earlier program left


@pytest.mark.parametrize(
    "left",
    [
        pytest.param(b"G1X-300F600\n", id="a move"),
        pytest.param(b"G1X-300F600\n!", id="a hold"),
        pytest.param(b"M3S1000\nG4P600\nM5\n", id="a lit lamp and a dwell"),
        pytest.param(b"$J=X-300F600\n", id="a jog"),
        pytest.param(b"G1X-300", id="half a line"),
        pytest.param(b"$C\n", id="check mode"),
        pytest.param(b"$SLP\n", id="sleep"),
        pytest.param(b"\x84", id="an open door"),
        pytest.param(b"G0X-400\n", id="an alarm that waits for a reset"),
    ],
)
def test_homing_begins_from_whatever_an_earlier_program_left(left: bytes) -> None:
    bench = Bench()
    homed(bench)
    bench.wire.feed(left)
    controller = homed(bench)
    assert controller.position() == (-1, -1, -1) == pytest.approx(bench.true_place(), abs=0.006)
    assert bench.sim.lamp.power == 0
