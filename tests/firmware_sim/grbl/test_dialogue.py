"""The light arm's controller over its bytes, with the clock in our hands."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.firmware_sim.grbl.host import BANNER, UNLOCK, Host


def test_power_up_with_homing_locks() -> None:
    host = Host()
    assert host.hear() == BANNER + UNLOCK
    assert host.state() == "Alarm"
    assert host.type("G0X-1\n") == "error:9\r\n"


def test_the_controller_does_not_know_where_the_arm_is_until_it_is_homed() -> None:
    host = Host()
    host.hear()
    assert host.place() == (0, 0, 0) != host.true_place()
    assert host.type("$H\n") == ""
    assert host.wait(60) == "ok\r\n"
    assert host.place() == (-1, -1, -1) == host.true_place()
    assert host.state() == "Idle"


def test_a_question_during_homing_is_answered_once_at_its_end() -> None:
    host = Host()
    host.hear()
    assert host.type("$H\n??") == ""
    assert host.wait(1) == ""
    said = host.wait(60)
    assert said.startswith("<Home|MPos:-1.000,-1.000,-1.000|")
    assert said.endswith("ok\r\n")
    assert said.count("<") == 1


def test_reports_rotate_through_offsets_and_overrides() -> None:
    host = Host.homed()
    extras = [host.fields()[4:] for _ in range(12)]
    assert extras[0] == ["WCO:0.000,0.000,0.000"]
    assert extras[1] == ["Ov:100,100,100"]
    assert extras[2:10] == [[]] * 8
    assert extras[10:] == [["WCO:0.000,0.000,0.000"], ["Ov:100,100,100"]]


def test_a_report_has_position_buffers_and_feed() -> None:
    host = Host.homed()
    assert host.fields()[:4] == ["Idle", "MPos:-1.000,-1.000,-1.000", "Bf:15,128", "FS:0,0"]


def test_a_move_is_acknowledged_when_planned_and_takes_its_time() -> None:
    host = Host.homed()
    assert host.type("G1 X-61 F3600\n") == "ok\r\n"
    assert host.state() == "Run"
    host.clock.pass_s(0.5 + 60 / 1000)
    assert host.fields()[3] == "FS:3600,0"
    assert host.place()[0] == pytest.approx(-1 - 30.0, abs=0.011)
    host.wait(0.5 + 60 / 1000)
    assert host.state() == "Idle"
    assert host.place() == (-61, -1, -1)


def test_a_dwell_of_nothing_waits_for_the_end_of_motion() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    assert host.type("G4 P0\n") == ""
    assert host.wait(1.1) == ""
    assert host.wait(0.1) == "ok\r\n"


def test_a_dwell_counts_from_the_end_of_motion() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\nG4 P0.5\n")
    assert host.wait(1.6) == ""
    assert host.wait(0.1) == "ok\r\n"


def test_the_queue_takes_fifteen_moves_and_the_sixteenth_waits() -> None:
    host = Host.homed()
    said = host.type("".join(f"G1X-{place}F600\n" for place in range(2, 14)))
    said += host.type("".join(f"G1X-{place}F600\n" for place in range(14, 18)))
    assert said == "ok\r\n" * 15
    assert host.fields()[2].startswith("Bf:0,")
    assert host.wait(0.2) == "ok\r\n"
    host.wait(60)
    assert host.place()[0] == -17


def test_the_slower_axis_sets_the_pace() -> None:
    host = Host.homed()
    host.type("$111=60\n")
    host.type("G0 X-11 Y-2\n")
    host.wait(0.5)
    assert host.place() == pytest.approx((-6, -1.5, -1), abs=0.15)


TABLE_OF_LINES = [
    ("\n", "ok", "an empty line"),
    ("(nothing) ; at all\n", "ok", "comments alone"),
    ("g0 x - 2 (away)\n", "ok", "lower case, spaces, a comment"),
    ("G0 X\n", "error:2", "a word without a number"),
    ("G0 X1.2.3\n", "error:1", "a number with two points"),
    ("5\n", "error:1", "a number without a letter"),
    ("G1 X-5\n", "error:22", "no feed yet"),
    ("G1 X-5 F0\n", "error:22", "a feed of zero"),
    ("F-5\n", "error:4", "a negative feed"),
    ("G0 X-1 X-2\n", "error:25", "a word twice"),
    ("G90 G91\n", "error:21", "two modes of a group"),
    ("G0.5\n", "error:23", "half a command"),
    ("G2 X-1 I1\n", "error:20", "an arc"),
    ("G10 L2 P1 X0\n", "ok", "work offsets"),
    ("G10 L2 P7 X0\n", "error:29", "a seventh work offset"),
    ("G10 L2 X0\n", "error:28", "a work offset without its number"),
    ("G10 L3 P1 X0\n", "error:20", "tool offsets"),
    ("G10 L2 P1\n", "error:26", "a work offset without an axis"),
    ("G92\n", "error:26", "a shift without an axis"),
    ("G38.2 Z-1 F10\n", "error:20", "probing"),
    ("G43.1 Z1\n", "error:20", "tool lengths"),
    ("G93\n", "error:20", "inverse time"),
    ("M8\n", "ok", "coolant"),
    ("M6\n", "error:20", "tool change"),
    ("M3 M5\n", "error:21", "two spindle commands"),
    ("M2.5\n", "error:23", "half a program end"),
    ("N-1\n", "error:4", "a negative line number"),
    ("N20000000\n", "error:27", "a line number out of range"),
    ("N10 T3 G17 G40 G49 G54 G61 G91.1\n", "ok", "words that change nothing"),
    ("G0 A-1\n", "error:20", "an axis that it has not"),
    ("Q1\n", "error:20", "a letter that no command has"),
    ("G4\n", "error:28", "a dwell without its time"),
    ("G0 X-1 P1\n", "error:36", "a word that nothing uses"),
    ("G80 X-1\n", "error:31", "axis words after motion was cancelled"),
    ("G80 G53\n", "error:30", "machine coordinates without a motion"),
    ("G0 G28 X-1\n", "error:24", "two commands that want the axes"),
    ("G1" + "0" * 80 + "X-1\n", "error:11", "more characters than the line buffer holds"),
    ("$J=X-5\n", "error:22", "a jog without a feed"),
    ("$J=G0X-5F100\n", "error:16", "a jog with a motion mode"),
    ("$J=F100\n", "error:26", "a jog without an axis"),
    ("$J=X5F100\n", "error:15", "a jog out of the travel"),
    ("$Z\n", "error:2", "no such command"),
    ("$XX\n", "error:3", "a command with more behind it"),
    ("$999=1\n", "error:3", "no such setting"),
    ("$110=x\n", "error:2", "a setting without a number"),
    ("$110=-1\n", "error:4", "a negative setting"),
    ("$0=2\n", "error:6", "a step pulse too short"),
    ("$HX\n", "error:3", "homing of one axis, which this build does not know"),
    ("$RST=9\n", "error:3", "no such memory"),
    ("$N2=G20\n", "error:3", "a third start-up line"),
    ("$N0=G99\n", "error:20", "a start-up line that is wrong"),
]


@pytest.mark.parametrize(
    ("line", "answer"), [row[:2] for row in TABLE_OF_LINES], ids=[row[2] for row in TABLE_OF_LINES]
)
def test_each_line_has_its_answer(line: str, answer: str) -> None:
    assert Host.homed().type(line) == answer + "\r\n"


def test_a_refused_line_changes_no_mode() -> None:
    host = Host.homed()
    before = host.type("$G\n")
    assert host.type("G91 G1 F100 X-1 X-2\n") == "error:25\r\n"
    assert host.type("$G\n") == before


def test_modes_stay_from_line_to_line() -> None:
    host = Host.homed()
    host.type("G91 G1 X-10 F6000\n")
    host.type("X-10\n")
    host.wait(5)
    assert host.place()[0] == -21
    host.type("G90 G20 X-1\n")
    host.wait(5)
    assert host.place()[0] == -25.4
    assert "G1 G54 G17 G20 G90 G94" in host.type("$G\n")


def test_machine_coordinates_are_absolute_whatever_the_mode() -> None:
    host = Host.homed()
    host.type("G91\nG53 G0 X-30\n")
    host.wait(5)
    assert host.place()[0] == -30


def test_g28_goes_to_machine_zero_by_way_of_what_it_names() -> None:
    host = Host.homed()
    host.type("G28 X-50\n")
    host.wait(30)
    assert host.place() == (0, -1, -1), "only the axes that it names go there"
    host.type("G28\n")
    host.wait(30)
    assert host.place() == (0, 0, 0)


def test_hold_stops_on_the_path_and_resume_goes_on() -> None:
    host = Host.homed()
    host.type("G1 X-61 Y-31 F3600\n")
    host.wait(0.4)
    assert host.type("!") == ""
    assert host.state() == "Hold:1"
    host.wait(0.2)
    assert host.state() == "Hold:0"
    x, y, _ = host.place()
    assert (x + 1) / (y + 1) == pytest.approx(2, abs=0.01)
    assert host.type("G0X-1\n") == ""
    host.type("~")
    assert host.state() == "Run"
    host.wait(10)
    assert host.state() == "Idle"
    assert host.place()[0] == -1


def test_a_reset_on_hold_keeps_the_position() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG1 X-61 F3600\n")
    host.wait(0.4)
    host.type("!")
    host.wait(0.3)
    place = host.place()
    assert host.type("\x18") == BANNER
    assert host.state() == "Idle"
    assert host.place() == place == pytest.approx(host.true_place(), abs=0.006)
    assert host.arm.lamp.power == 0


def test_a_reset_in_motion_loses_the_position() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    host.wait(0.5)
    assert host.type("\x18") == "ALARM:3\r\n"
    assert host.type("?") == ""
    assert host.wait(0.6) == BANNER + UNLOCK
    assert host.state() == "Alarm"
    assert abs(host.place()[0] - host.true_place()[0]) > 0.5
    host.type("$H\n")
    host.wait(60)
    assert host.place() == host.true_place()


def test_a_soft_limit_stops_on_the_path_and_keeps_the_position() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG1 X-61 F3600\n")
    host.wait(0.4)
    assert host.type("G1 X-400\n") == ""
    assert host.wait(0.5) == "ALARM:2\r\n"
    assert host.arm.lamp.power == 0
    assert host.type("\x18") == ""
    assert host.wait(0.5) == "[MSG:Reset to continue]\r\n"
    assert host.type("?$X\n") == ""
    assert host.type("\x18") == BANNER + UNLOCK
    assert host.type("$X\n") == "[MSG:Caution: Unlocked]\r\nok\r\n"
    assert host.place() == pytest.approx(host.true_place(), abs=0.006)


def test_without_soft_limits_the_travel_is_not_watched() -> None:
    host = Host.homed()
    assert host.type("$20=0\nG0 X5\n") == "ok\r\nok\r\n"


def test_soft_limits_need_homing() -> None:
    host = Host.homed()
    assert host.type("$22=0\n") == "ok\r\n"
    assert "$20=0\r\n" in host.type("$$\n")
    assert host.type("$20=1\n") == "error:10\r\n"
    assert host.type("$H\n") == "error:5\r\n"


@pytest.mark.parametrize(
    ("fault", "alarm"),
    [
        pytest.param("stuck", "ALARM:8\r\n", id="a switch that stays pressed fails the pull-off"),
        pytest.param("dead", "ALARM:9\r\n", id="a switch that is never pressed is not found"),
    ],
)
def test_homing_fails_with_its_alarm(fault: str, alarm: str) -> None:
    host = Host()
    host.hear()
    host.arm.break_switches("stuck" if fault == "stuck" else "dead")
    host.type("$H\n")
    assert host.wait(600) == alarm + BANNER + UNLOCK
    assert host.state() == "Alarm"


def test_a_reset_during_homing_ends_it() -> None:
    host = Host()
    host.hear()
    host.type("$H\n")
    host.wait(0.5)
    assert host.type("\x18") == "ALARM:6\r\n"
    stopped = host.true_place()
    assert host.wait(5) == BANNER + UNLOCK
    assert host.true_place() == stopped


def test_a_limit_switch_stops_everything_if_hard_limits_are_on() -> None:
    host = Host.homed()
    host.type("$21=1\nG1 X-61 F3600\n")
    host.wait(0.3)
    host.arm.break_switches("stuck")
    assert host.hear() == "ALARM:1\r\n"
    stopped = host.true_place()
    assert host.wait(1) == "[MSG:Reset to continue]\r\n"
    assert host.true_place() == stopped


def test_a_pressed_switch_shows_in_reports() -> None:
    host = Host.homed()
    host.arm.break_switches("stuck")
    assert "Pn:XYZ" in host.fields()


def test_a_jog_is_cancelled_on_its_way() -> None:
    host = Host.homed()
    assert host.type("$J=G91 X-100 F3600\n") == "ok\r\n"
    host.wait(0.5)
    assert host.state() == "Jog"
    assert host.type("G0X-1\n") == "error:9\r\n"
    host.type(b"\x85")
    host.wait(1)
    assert host.state() == "Idle"
    assert -40 < host.place()[0] < -25
    assert host.type("G91 G0 X-1\n") == "ok\r\n"


def test_a_hold_cancels_a_jog_too() -> None:
    host = Host.homed()
    host.type("$J=G91 X-100 F3600\n")
    host.wait(0.5)
    host.type("!")
    host.wait(1)
    assert host.state() == "Idle"


def test_the_door_stops_and_darkens_and_resume_brings_both_back() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG1 X-61 F3600\n")
    host.wait(0.4)
    assert host.type(b"\x84") == "[MSG:Check Door]\r\n"
    assert host.arm.lamp.power == 0
    assert host.state() == "Door:2"
    host.wait(0.5)
    assert host.state() == "Door:0"
    host.type("~")
    assert (host.state(), host.arm.lamp.power) == ("Door:3", 1)
    host.wait(10)
    assert host.state() == "Idle"
    assert host.place()[0] == -61


def test_settings_are_listed_and_survive_a_reset() -> None:
    host = Host.homed()
    assert host.type("$110=3000\n") == "ok\r\n"
    host.type("\x18")
    listed = host.type("$$\n")
    assert "$110=3000.000\r\n" in listed
    assert "$130=360.000\r\n$131=90.000\r\n" in listed
    assert listed.endswith("ok\r\n")


@pytest.mark.parametrize(
    ("command", "contains"),
    [
        ("$\n", "[HLP:$$ $#"),
        ("$I\n", "[VER:1.1h."),
        ("$N\n", "$N0=\r\n$N1=\r\n"),
        ("$#\n", "[G54:0.000,0.000,0.000]"),
        ("$G\n", "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"),
    ],
)
def test_the_controller_tells_about_itself(command: str, contains: str) -> None:
    said = Host.homed().type(command)
    assert contains in said
    assert said.endswith("ok\r\n")


@pytest.mark.parametrize("command", ["$$\n", "$110=1\n", "$H\n", "$J=X-1F1\n"])
def test_settings_and_homing_want_an_idle_machine(command: str) -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    assert host.type(command) == "error:8\r\n"


def test_the_lamp_changes_only_after_the_moves_before_it() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    assert host.type("M3 S1000\n") == ""
    assert host.arm.lamp.power == 0
    host.wait(2)
    switched = host.arm.lamp
    assert switched.power == 1
    assert switched.power_at(host.clock.now_s - 1.5) == 0


@pytest.mark.parametrize(
    ("line", "power"),
    [
        pytest.param("M3 S1000", 1, id="full"),
        pytest.param("M4 S2000", 1, id="more than full is full"),
        pytest.param("M3 S500", 128 / 255, id="half, in steps of the 8-bit PWM"),
        pytest.param("M3 S0", 0, id="on, at no speed"),
        pytest.param("S1000", 0, id="a speed alone switches nothing on"),
        pytest.param("M3 S1000\nM5", 0, id="off"),
    ],
)
def test_the_lamp_is_as_bright_as_the_spindle_is_fast(line: str, power: float) -> None:
    host = Host.homed()
    host.type(line + "\n")
    assert host.arm.lamp.power == pytest.approx(power)


def test_a_lit_lamp_shows_in_reports() -> None:
    host = Host.homed()
    host.type("M3 S700\n")
    reports = [host.fields() for _ in range(2)]
    assert reports[0][3] == "FS:0,700"
    assert reports[1][-1] == "A:S"


def test_characters_beyond_the_receive_buffer_are_lost() -> None:
    host = Host.homed()
    host.type("G1 X-100 F60\nG4 P0\n")
    host.type("X" * 200)
    assert host.fields()[2] == "Bf:14,0"


@given(st.binary(max_size=60))
def test_no_line_noise_brings_the_firmware_down(noise: bytes) -> None:
    host = Host.homed()
    host.type(noise)
    host.wait(2)
    host.type(b"\x18")
    host.wait(2)
    host.type(b"\x18")
    assert re.fullmatch(r"<(Idle|Alarm)\|MPos:.*>\r\n", host.type("?"))
