import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.errors import GarbledReplyError
from rig.grbl.codec import Alarm, Ok, Refusal, Reply, Setting, Status, Text, parse_line


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        pytest.param(b"ok\r\n", Ok(), id="ok"),
        pytest.param(b"error:9", Refusal(9), id="locked"),
        pytest.param(b"ALARM:2", Alarm(2), id="soft limit"),
        pytest.param(b"Grbl 1.1h ['$' for help]", Text("Grbl 1.1h ['$' for help]", "banner"), id="banner"),
        pytest.param(b"[MSG:'$H'|'$X' to unlock]", Text("[MSG:'$H'|'$X' to unlock]", "message"), id="message"),
        pytest.param(b"$130=360.000", Setting(130, 360), id="setting"),
        pytest.param(b"$132=10.000 (z max travel, mm)", Setting(132, 10), id="a setting with its name behind it"),
        pytest.param(b"$N0=G21", Text("$N0=G21", "other"), id="a start-up line is no setting"),
        pytest.param(
            b"<Idle|MPos:-1.000,-1.000,-1.000|Bf:15,128|FS:0,0|WCO:0.000,0.000,0.000>",
            Status("Idle", None, (-1, -1, -1), None, (0, 0, 0), 15, 128),
            id="report with a work offset",
        ),
        pytest.param(
            b"<Hold:0|WPos:-2.5,3.25,0.0|FS:0,0|Ov:100,100,100>",
            Status("Hold", 0, None, (-2.5, 3.25, 0)),
            id="work position",
        ),
        pytest.param(b"<Alarm|MPos:0.0,0.0,0.0|Pn:XY>", Status("Alarm", None, (0, 0, 0), pins="XY"), id="pins"),
    ],
)
def test_lines_mean_what_the_firmware_says(line: bytes, reply: Reply) -> None:
    assert parse_line(line) == reply


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        pytest.param(
            b"<Run|MPos:1.000,2.000,3.000,4.000|Bf:100,1023|FS:600,0|WCS:G54|A:S|TLR:0|H:1,7|Sc:|MPG:0>",
            Status("Run", None, (1, 2, 3, 4), None, None, 100, 1023),
            id="grblHAL: four axes, a larger buffer, fields of its own",
        ),
        pytest.param(
            b"<Alarm:11|MPos:0.000,0.000,0.000|Bf:100,1023|F:0>",
            Status("Alarm", 11, (0, 0, 0), None, None, 100, 1023),
            id="grblHAL: the alarm's number in the state, a feed alone",
        ),
        pytest.param(
            b"<Idle|MPos:0.000,0.000,0.000,0.000,0.000,0.000|FS:0,0|SD:0.0,/job.nc|Ov:100,100,100>",
            Status("Idle", None, (0, 0, 0, 0, 0, 0)),
            id="FluidNC: six axes and a file",
        ),
    ],
)
def test_fields_of_other_dialects_do_no_harm(line: bytes, reply: Reply) -> None:
    assert parse_line(line) == reply


@pytest.mark.parametrize(
    ("banner", "dialect"),
    [
        ("Grbl 1.1h ['$' for help]", "grbl"),
        ("GrblHAL 1.1f ['$' or '$HELP' for help]", "grblHAL"),
        ("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]", "FluidNC"),
    ],
)
def test_the_banner_names_the_dialect(banner: str, dialect: str) -> None:
    reply = parse_line(banner.encode())
    assert isinstance(reply, Text)
    assert (reply.kind, reply.dialect) == ("banner", dialect)


@pytest.mark.parametrize(
    "line",
    [
        b"<Idle|MPos:-1.0",
        b"<Idle|MPos:x,y,z>",
        b"<Idle|MPos:1>",
        b"<Idle|MPos:1.0,inf,2.0>",
        b"<Idle|MPos:1.0,2.0.0,2.0>",
        b"<Idle|MPos:1.0,2.0,0.0|Bf:15>",
        b"<|MPos:1.0,2.0,0.0>",
        b"error:",
        b"ALARM:x1",
    ],
)
def test_damaged_answers_are_never_guessed_at(line: bytes) -> None:
    with pytest.raises(GarbledReplyError):
        parse_line(line)


@given(st.binary(max_size=80))
def test_no_line_at_all_crashes_the_parser(line: bytes) -> None:
    try:
        parse_line(line)
    except GarbledReplyError:
        return


@pytest.mark.parametrize(
    ("code", "lost"), [(1, True), (2, False), (3, True), (6, True), (7, True), (8, True), (9, True), (11, True)]
)
def test_alarms_know_whether_the_position_is_lost(code: int, lost: bool) -> None:
    assert Alarm(code).position_lost is lost


@pytest.mark.parametrize(
    ("report", "moving"),
    [
        (b"<Run|MPos:0,0>", True),
        (b"<Hold:1|MPos:0,0>", True),
        (b"<Hold:0|MPos:0,0>", False),
        (b"<Idle|MPos:0,0>", False),
    ],
)
def test_a_hold_moves_until_it_is_complete(report: bytes, moving: bool) -> None:
    status = parse_line(report)
    assert isinstance(status, Status)
    assert status.is_moving is moving
