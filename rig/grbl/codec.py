"""The lines of GRBL 1.1, both ways; pure, so that every dialect can be tested on bytes alone."""

import re
from dataclasses import dataclass
from typing import Literal, NamedTuple

from rig.errors import GarbledReplyError

STATUS_REPORT = b"?"
FEED_HOLD = b"!"
SOFT_RESET = b"\x18"

POSITION_LOSING_ALARMS = frozenset({1, 3, 6, 7, 8, 9})

ALARMS = {
    1: "a hard limit was hit",
    2: "the goal lies beyond the soft limits",
    3: "reset while moving",
    4: "probe fault",
    5: "probe fault",
    6: "homing was reset",
    7: "the door opened while homing",
    8: "homing could not clear the limit switch",
    9: "homing did not find the limit switch",
}

ERRORS = {
    1: "a command letter is missing",
    2: "a number is malformed",
    3: "unknown $ statement",
    8: "only possible when idle",
    9: "locked after an alarm",
    10: "soft limits need homing",
    11: "line too long",
    15: "jog beyond the machine's travel",
    20: "unsupported command",
    22: "no feed rate",
}


class Axes(NamedTuple):
    """Machine coordinates of the two joints, in the controller's millimetres, which are degrees here."""

    x: float
    y: float


@dataclass(frozen=True)
class Ok:
    """The line was taken; motion may still go on."""


@dataclass(frozen=True)
class Refusal:
    """`error:N`."""

    code: int

    def __str__(self) -> str:
        """Say it in words."""
        return f"error {self.code} ({ERRORS.get(self.code, 'see the GRBL documentation')})"


@dataclass(frozen=True)
class Alarm:
    """`ALARM:N`."""

    code: int

    @property
    def position_lost(self) -> bool:
        """Tell whether the controller must be homed again before it knows where it is."""
        return self.code in POSITION_LOSING_ALARMS

    def __str__(self) -> str:
        """Say it in words."""
        return f"alarm {self.code} ({ALARMS.get(self.code, 'see the GRBL documentation')})"


@dataclass(frozen=True)
class Status:
    """A `<…>` report; the work offset is there in some reports only."""

    state: str
    machine: Axes | None
    work: Axes | None
    work_offset: Axes | None


@dataclass(frozen=True)
class Text:
    """A banner, message or setting, kept as it came."""

    text: str
    kind: Literal["banner", "message", "setting", "other"]


Reply = Ok | Refusal | Alarm | Status | Text


def parse_line(line: bytes) -> Reply:
    """Tell what one line from the controller means.

    Raises
    ------
    GarbledReplyError
        It begins like an answer and is damaged.
    """
    text = line.decode("ascii", errors="replace").strip()
    if text == "ok":
        return Ok()
    if text.startswith("<"):
        return _parse_status(text)
    if match := re.fullmatch(r"(error|ALARM):(\d+)", text):
        return Refusal(int(match[2])) if match[1] == "error" else Alarm(int(match[2]))
    if text.startswith(("error", "ALARM")):
        raise GarbledReplyError(f"damaged answer {text[:40]!r}")
    if text.startswith("Grbl"):
        return Text(text, "banner")
    return Text(text, "message" if text.startswith("[") else "setting" if text.startswith("$") else "other")


def move_line(goal: Axes, feed_deg_min: float) -> bytes:
    """Write a straight move in machine coordinates at a feed rate."""
    return f"G21 G90 G94 G53 G1 X{goal.x:.3f} Y{goal.y:.3f} F{feed_deg_min:.1f}\n".encode()


def spindle_line(power: float) -> bytes:
    """Write the spindle command that lights the lamp, or darkens it at zero."""
    return f"M3 S{power:.1f}\n".encode() if power > 0 else b"M5\n"


def _parse_status(text: str) -> Status:
    if not text.endswith(">"):
        raise GarbledReplyError(f"status report cut short: {text[:60]!r}")
    state, *fields = text[1:-1].split("|")
    values = dict(field.split(":", 1) for field in fields if ":" in field)
    try:
        machine, work, offset = (_axes(values.get(key)) for key in ("MPos", "WPos", "WCO"))
    except ValueError as error:
        raise GarbledReplyError(f"damaged status report {text[:60]!r}") from error
    return Status(state, machine, work, offset)


def _axes(value: str | None) -> Axes | None:
    if value is None:
        return None
    numbers = [float(number) for number in value.split(",")]
    if len(numbers) < 2:
        raise ValueError("fewer than two axes")
    return Axes(numbers[0], numbers[1])
