"""What a GRBL 1.1 controller says, and its relatives grblHAL and FluidNC; pure, so that bytes alone test it."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from rig.errors import GarbledReplyError

Position = tuple[float, ...]
"""Machine coordinates, axis by axis, in the controller's millimetres, which are degrees here."""

POSITION_KEEPING_ALARMS = frozenset({2, 4, 5})
"""Of every other alarm, those of other dialects too, the position counts as lost."""

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
    10: "emergency stop",
    11: "homing is required",
}

ERRORS = {
    1: "a command letter is missing",
    2: "a number is malformed",
    3: "unknown $ statement",
    4: "a negative value",
    5: "homing is switched off",
    8: "only possible when idle",
    9: "locked after an alarm",
    10: "soft limits need homing",
    11: "line too long",
    15: "jog beyond the machine's travel",
    16: "malformed jog",
    17: "laser mode needs a PWM output",
    20: "unsupported command",
    22: "no feed rate",
    33: "impossible target",
    36: "unused words",
}

Dialect = Literal["grbl", "grblHAL", "FluidNC"]


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
        return self.code not in POSITION_KEEPING_ALARMS

    def __str__(self) -> str:
        """Say it in words."""
        return f"alarm {self.code} ({ALARMS.get(self.code, 'see the documentation of its firmware')})"


@dataclass(frozen=True)
class Status:
    """A `<…>` report. Work offset and overrides are there in some reports only; dialects add fields of their own.

    Attributes
    ----------
    state : its name, without the number behind the colon
    phase : that number: of a hold 0 at rest, 1 while braking
    machine, work, work_offset : positions, as far as they are told
    free_blocks, free_bytes : room in planner and receive buffer
    pins : letters of inputs that are active
    fields : everything as it came
    """

    state: str
    phase: int | None = None
    machine: Position | None = None
    work: Position | None = None
    work_offset: Position | None = None
    free_blocks: int | None = None
    free_bytes: int | None = None
    pins: str = ""
    fields: Mapping[str, str] = field(default_factory=dict, compare=False)

    @property
    def is_moving(self) -> bool:
        """Tell whether motors turn, as far as the state says so."""
        return self.state in ("Run", "Jog", "Home") or (self.state == "Hold" and self.phase == 1)


@dataclass(frozen=True)
class Setting:
    """`$n=value`; a dialect's value may be text."""

    number: int
    value: float


@dataclass(frozen=True)
class Text:
    """A banner or message, kept as it came."""

    text: str
    kind: Literal["banner", "message", "other"]

    @property
    def dialect(self) -> Dialect:
        """The firmware that a banner names."""
        if "FluidNC" in self.text:
            return "FluidNC"
        return "grblHAL" if "HAL" in self.text else "grbl"


Reply = Ok | Refusal | Alarm | Status | Setting | Text


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
    if match := re.fullmatch(r"(error|ALARM):(\d{1,3})", text):
        return Refusal(int(match[2])) if match[1] == "error" else Alarm(int(match[2]))
    if text.startswith(("error", "ALARM")):
        raise GarbledReplyError(f"damaged answer {text[:40]!r}")
    if text.startswith("Grbl"):
        return Text(text, "banner")
    if match := re.match(r"\$(\d{1,4})=([+-]?\d+(?:\.\d*)?)(?: |$)", text):
        return Setting(int(match[1]), float(match[2]))
    return Text(text, "message" if text.startswith("[") else "other")


def _parse_status(text: str) -> Status:
    if not text.endswith(">"):
        raise GarbledReplyError(f"status report cut short: {text[:60]!r}")
    state, *fields = text[1:-1].split("|")
    found = re.fullmatch(r"([A-Z][a-z]+)(?::(\d{1,2}))?", state)
    values = dict(item.split(":", 1) for item in fields if ":" in item)
    if found is None:
        raise GarbledReplyError(f"status report without a state: {text[:60]!r}")
    try:
        machine, work, offset = (_position(values.get(key)) for key in ("MPos", "WPos", "WCO"))
        room = [int(number) for number in values["Bf"].split(",")] if "Bf" in values else [None, None]
        blocks, characters = room
    except ValueError as error:
        raise GarbledReplyError(f"damaged status report {text[:60]!r}") from error
    phase = None if found[2] is None else int(found[2])
    return Status(found[1], phase, machine, work, offset, blocks, characters, values.get("Pn", ""), values)


def _position(value: str | None) -> Position | None:
    if value is None:
        return None
    if not re.fullmatch(r"-?\d+(\.\d+)?(,-?\d+(\.\d+)?)+", value):
        raise ValueError("not a position")
    numbers = tuple(float(number) for number in value.split(","))
    if not all(math.isfinite(number) for number in numbers):
        raise ValueError("endless number")
    return numbers
