import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.errors import GarbledReplyError
from rig.grbl import codec
from rig.grbl.codec import Alarm, Axes, Ok, Refusal, Reply, Status, Text, parse_line


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        pytest.param(b"ok\r\n", Ok(), id="ok"),
        pytest.param(b"error:9", Refusal(9), id="locked"),
        pytest.param(b"ALARM:2", Alarm(2), id="soft limit"),
        pytest.param(b"Grbl 1.1h ['$' for help]", Text("Grbl 1.1h ['$' for help]", "banner"), id="banner"),
        pytest.param(b"[MSG:'$H'|'$X' to unlock]", Text("[MSG:'$H'|'$X' to unlock]", "message"), id="message"),
        pytest.param(b"$130=360.000", Text("$130=360.000", "setting"), id="setting"),
        pytest.param(
            b"<Idle|MPos:-1.000,-1.000,-1.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>",
            Status("Idle", Axes(-1, -1), None, Axes(0, 0)),
            id="report with a work offset",
        ),
        pytest.param(
            b"<Hold:0|WPos:-2.5,3.25,0.0|FS:0,0|Ov:100,100,100>",
            Status("Hold:0", None, Axes(-2.5, 3.25), None),
            id="work position",
        ),
        pytest.param(
            b"<Run|MPos:1.0,2.0,3.0,0.0|Bf:100,1023|FS:600,0|A:S|TLR:0|H:1>",
            Status("Run", Axes(1, 2), None, None),
            id="a dialect's extra fields",
        ),
    ],
)
def test_lines_mean_what_the_firmware_says(line: bytes, reply: Reply) -> None:
    assert parse_line(line) == reply


@pytest.mark.parametrize("line", [b"<Idle|MPos:-1.0", b"<Idle|MPos:x,y,z>", b"<Idle|MPos:1>", b"error:", b"ALARM:x1"])
def test_damaged_answers_are_never_guessed_at(line: bytes) -> None:
    with pytest.raises(GarbledReplyError):
        parse_line(line)


@given(st.binary(max_size=80))
def test_no_line_at_all_crashes_the_parser(line: bytes) -> None:
    try:
        parse_line(line)
    except GarbledReplyError:
        return


@pytest.mark.parametrize(("code", "lost"), [(1, True), (2, False), (3, True), (8, True), (9, True)])
def test_alarms_know_whether_the_position_is_lost(code: int, lost: bool) -> None:
    assert Alarm(code).position_lost is lost


def test_moves_are_absolute_machine_coordinates_at_a_feed() -> None:
    assert codec.move_line(Axes(-315, -45.5), 6000) == b"G21 G90 G94 G53 G1 X-315.000 Y-45.500 F6000.0\n"


def test_a_lamp_is_a_spindle() -> None:
    assert codec.spindle_line(750) == b"M3 S750.0\n"
    assert codec.spindle_line(0) == b"M5\n"
