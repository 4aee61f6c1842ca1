import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.errors import OutOfRangeError
from rig.grbl import commands
from rig.grbl.commands import AXES, Axis, Command, Dwell, Home, Jog, Light, Move, RealTime, SetSetting, encode


@pytest.mark.parametrize(
    ("command", "line"),
    [
        pytest.param(Move({"X": -315, "Y": -45.5}, 100), b"G21G90G94G53G1X-315.0000Y-45.5000F6000.0\n", id="move"),
        pytest.param(Move({"A": 0.08789}, 60), b"G21G90G94G53G1A0.0879F3600.0\n", id="a rotary axis"),
        pytest.param(Jog({"X": -1}, 10), b"$J=G21G90G53X-1.0000F600.0\n", id="jog"),
        pytest.param(Dwell(), b"G4P0.000\n", id="the dwell that waits for the planner"),
        pytest.param(Home(), b"$H\n", id="homing"),
        pytest.param(Light(750), b"G21G94G1F100M3S750.0\n", id="a lamp is a spindle, lit in laser mode too"),
        pytest.param(commands.Dark(), b"M5\n", id="dark"),
        pytest.param(SetSetting(130, 360), b"$130=360.000\n", id="setting"),
        pytest.param(commands.Help(), b"$\n", id="help"),
    ],
)
def test_commands_are_lines(command: Command, line: bytes) -> None:
    assert encode(command) == line


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(Move({"X": math.nan}, 1), id="no number"),
        pytest.param(Move({"X": 1}, math.inf), id="endless speed"),
        pytest.param(Light(-math.inf), id="endless power"),
        pytest.param(Move({}, 1), id="no axis"),
        pytest.param(Move({"X!": 1}, 1), id="a hold within an axis"),  # type: ignore[dict-item]
        pytest.param(Move({"X\x18": 1}, 1), id="a reset within an axis"),  # type: ignore[dict-item]
        pytest.param(Move(dict.fromkeys(AXES, 1000000000000000.0), 1), id="longer than the firmware's buffer"),
    ],
)
def test_what_must_not_be_sent_is_refused(command: Command) -> None:
    with pytest.raises(OutOfRangeError, match="nothing was"):
        encode(command)


@given(st.dictionaries(st.sampled_from(AXES), st.floats(-1e5, 1e5), min_size=1, max_size=3), st.floats(0.001, 1e4))
def test_no_line_holds_a_byte_that_acts_at_once(goal: dict[Axis, float], speed_deg_s: float) -> None:
    line = encode(Move(goal, speed_deg_s))
    assert line.endswith(b"\n")
    assert not {byte.value[0] for byte in RealTime} & set(line)
    assert all(0x20 <= byte < 0x7F for byte in line[:-1])
