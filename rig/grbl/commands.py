"""What the drivers may say to a GRBL 1.1 controller: typed commands, and nothing else. Pure.

A line is put together here and looked through before it leaves: a control byte in it would act at once, wherever the
firmware stands in its text.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Literal

from rig.errors import OutOfRangeError

Axis = Literal["X", "Y", "Z", "A", "B", "C"]
AXES: tuple[Axis, ...] = ("X", "Y", "Z", "A", "B", "C")
LONGEST_LINE = 79
"""Characters that fit the firmware's line buffer."""
_HARMLESS = re.compile(r"[ -~]*")
_ACTING = frozenset("?!~")


class RealTime(Enum):
    """Bytes that act at once, without a line's end and without an `ok`."""

    STATUS = b"?"
    HOLD = b"!"
    RESUME = b"~"
    RESET = b"\x18"
    DOOR = b"\x84"
    JOG_CANCEL = b"\x85"


@dataclass(frozen=True)
class Help:
    """The shortest question: its `ok` tells that the firmware reads lines.

    Behind half a line that somebody has left it makes an error of the whole; an empty line would have it done.
    """


@dataclass(frozen=True)
class Home:
    """The homing cycle, of all axes that have one."""


@dataclass(frozen=True)
class Unlock:
    """Leave the alarm without homing."""


@dataclass(frozen=True)
class Sleep:
    """Motors off; only a reset wakes it."""


@dataclass(frozen=True)
class AskSettings:
    """List the `$` settings."""


@dataclass(frozen=True)
class SetSetting:
    """Change one of them, in the controller's EEPROM."""

    number: int
    value: float


@dataclass(frozen=True)
class Move:
    """A straight move in machine coordinates, degrees, at a speed along its path."""

    goal: Mapping[Axis, float]
    speed_deg_s: float


@dataclass(frozen=True)
class Jog:
    """The same, which a jog cancel ends without losing the position."""

    goal: Mapping[Axis, float]
    speed_deg_s: float


@dataclass(frozen=True)
class Dwell:
    """Wait until the planner is empty, and then so long."""

    seconds: float = 0.0


@dataclass(frozen=True)
class Light:
    """The spindle or laser output on, at a power in the unit of $30.

    With G1 in force, for in laser mode ($32=1) the output stays dark under G0; it wants a feed, which nothing uses.
    """

    power: float


@dataclass(frozen=True)
class Dark:
    """The output off, once the planner is empty."""


Command = Help | Home | Unlock | Sleep | AskSettings | SetSetting | Move | Jog | Dwell | Light | Dark


def encode(command: Command) -> bytes:
    """Return the line of a command, with its end.

    Raises
    ------
    OutOfRangeError
        A number in it is not finite, an axis does not exist, or the line holds what must not be in one.
    """
    text = _text(command)
    if len(text) > LONGEST_LINE or not _HARMLESS.fullmatch(text) or _ACTING & set(text):
        raise OutOfRangeError(f"GRBL: {text!r} is no line that may be sent; nothing was")
    return text.encode("ascii") + b"\n"


def may_be_repeated(command: Command) -> bool:
    """Tell whether saying it twice does the same as once; goals are absolute, so that nearly all may."""
    return not isinstance(command, Home | Sleep)


def _text(command: Command) -> str:
    match command:
        case Help():
            return "$"
        case Home():
            return "$H"
        case Unlock():
            return "$X"
        case Sleep():
            return "$SLP"
        case AskSettings():
            return "$$"
        case SetSetting(number, value):
            return f"${number:d}={_number(value, 3)}"
        case Move(goal, speed_deg_s):
            return f"G21G90G94G53G1{_words(goal)}F{_number(60 * speed_deg_s, 1)}"
        case Jog(goal, speed_deg_s):
            return f"$J=G21G90G53{_words(goal)}F{_number(60 * speed_deg_s, 1)}"
        case Dwell(seconds):
            return f"G4P{_number(seconds, 3)}"
        case Light(power):
            return f"G21G94G1F100M3S{_number(power, 1)}"
        case Dark():
            return "M5"


def _words(goal: Mapping[Axis, float]) -> str:
    if not goal:
        raise OutOfRangeError("GRBL: a move without an axis; nothing was sent")
    return "".join(f"{_axis(axis)}{_number(place, 4)}" for axis, place in goal.items())


def _axis(letter: str) -> str:
    if letter not in AXES:
        raise OutOfRangeError(f"GRBL: {letter!r} is no axis (one of {', '.join(AXES)}); nothing was sent")
    return letter


def _number(value: float, decimals: int) -> str:
    if not math.isfinite(value):
        raise OutOfRangeError(f"GRBL: {value} is no number to send; nothing was")
    return f"{value:.{decimals}f}"
