"""What a line of G-code means, given the lines before it. Nothing moves here.

G17, G40, G49, G54, G61, G80, G94 are accepted since they are what the controller does anyway. Arcs, probing, work
offsets, coolant, tools and program flow have no use on a light arm and are answered with error:20.
"""

from dataclasses import dataclass, field

from firmware_sim.grbl.errors import Code, GrblError
from firmware_sim.grbl.settings import AXES
from firmware_sim.grbl.words import Word, split_words
from firmware_sim.motion import Vector

MM_PER_INCH = 25.4

_GROUPS = {
    0: "motion", 1: "motion", 80: "motion", 4: "once", 28: "once", 53: "once", 17: "plane", 20: "units", 21: "units",
    40: "cutter", 49: "length", 54: "offset", 61: "path", 90: "distance", 91: "distance", 94: "feed",
}  # fmt: skip
_FRACTIONS_OF_OTHERS = {28.1, 30.1, 38.2, 38.3, 38.4, 38.5, 43.1, 59.1, 59.2, 59.3, 61.1, 90.1, 91.1, 92.1, 92.2, 92.3}
_VALUE_LETTERS = set("FSPXYZ")
_LETTERS_OF_OTHERS = set("IJKLRTN")


@dataclass(frozen=True)
class Line:
    """The words of a line, sorted: G codes by modal group, M code, values."""

    codes: dict[str, int]
    spindle: int | None
    values: dict[str, float]

    @property
    def once(self) -> int | None:
        return self.codes.get("once")

    def axes(self) -> dict[int, float]:
        return {place: self.values[axis] for place, axis in enumerate(AXES) if axis in self.values}


def sort_words(text: str) -> Line:
    """Read a line and refuse what contradicts itself, whatever came before.

    Raises
    ------
    GrblError
        The first thing wrong with the line.
    """
    codes: dict[str, int] = {}
    values: dict[str, float] = {}
    spindle: int | None = None
    for word in split_words(text):
        if word.letter == "G":
            code = _known_code(word)
            if _GROUPS[code] in codes:
                raise GrblError(Code.MODAL_GROUP_VIOLATION)
            codes[_GROUPS[code]] = code
        elif word.letter == "M":
            if spindle is not None:
                raise GrblError(Code.MODAL_GROUP_VIOLATION)
            spindle = _known_spindle(word)
        else:
            _add_value(values, word)
    return Line(codes, spindle, values)


def _known_code(word: Word) -> int:
    code = int(word.value)
    if word.value != code:
        others = round(word.value, 3) in _FRACTIONS_OF_OTHERS
        raise GrblError(Code.UNSUPPORTED_COMMAND if others else Code.COMMAND_VALUE_NOT_INTEGER)
    if code not in _GROUPS:
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    return code


def _known_spindle(word: Word) -> int:
    if word.value != int(word.value):
        raise GrblError(Code.COMMAND_VALUE_NOT_INTEGER)
    if word.value not in (3, 4, 5):
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    return int(word.value)


def _add_value(values: dict[str, float], word: Word) -> None:
    if word.letter not in _VALUE_LETTERS | _LETTERS_OF_OTHERS:
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    if word.letter in values:
        raise GrblError(Code.WORD_REPEATED)
    if word.letter in "FSPNT" and word.value < 0:
        raise GrblError(Code.NEGATIVE_VALUE)
    values[word.letter] = word.value


@dataclass
class Modes:
    """What the lines before have set; `units` is 1 for G21 and 25.4 for G20."""

    motion: int = 0
    relative: bool = False
    units: float = 1.0
    feed: float = 0.0
    spindle: int = 5
    speed: float = 0.0

    def describe(self) -> str:
        """Print the modes, as `$G` does."""
        distance, units = ("G91" if self.relative else "G90"), ("G21" if self.units == 1 else "G20")
        codes = f"G{self.motion} G54 G17 {units} {distance} G94 M{self.spindle} M9 T0"
        return f"[GC:{codes} F{self.feed / self.units:.0f} S{self.speed:.0f}]\r\n"


@dataclass(frozen=True)
class Move:
    """A straight way; `feed` None means as fast as the axes can."""

    target: Vector
    feed: float | None


@dataclass(frozen=True)
class Task:
    """What a line asks to be done, in this order; None or empty means: nothing of the kind."""

    spindle: tuple[int, float] | None = None
    dwell_s: float | None = None
    moves: tuple[Move, ...] = field(default=())


def interpret(line: Line, modes: Modes, position: Vector, home: Vector) -> tuple[Task, Modes]:
    """Work out a line against the modes in force.

    Parameters
    ----------
    line : the sorted words
    modes : in force before the line
    position : machine coordinates where the moves planned so far end
    home : machine coordinates that G28 goes to

    Returns
    -------
    task, modes : what to do, and the modes in force afterwards

    Raises
    ------
    GrblError
        The line cannot be done; the modes stay as they were.
    """
    after = _new_modes(line, modes)
    _refuse_misfits(line, after)
    spindle = (after.spindle, after.speed)
    changed = spindle != (modes.spindle, modes.speed)
    dwell_s = line.values.get("P") if line.once == 4 else None
    return Task(spindle if changed else None, dwell_s, _moves(line, after, position, home)), after


def interpret_jog(text: str, modes: Modes, position: Vector) -> Move:
    """Work out a `$J=` line, which keeps the modes as they are and says everything itself.

    Raises
    ------
    GrblError
        The line has other words than G20, G21, G53, G90, G91, X, Y, Z and F, or lacks an axis or F.
    """
    line = sort_words(text)
    allowed = {"units", "distance"} | ({"once"} if line.once == 53 else set())
    if line.codes.keys() - allowed or line.spindle is not None:
        raise GrblError(Code.INVALID_JOG_COMMAND)
    if line.values.keys() - set("XYZF"):
        raise GrblError(Code.UNUSED_WORDS)
    if not line.axes():
        raise GrblError(Code.NO_AXIS_WORDS)
    if not line.values.get("F"):
        raise GrblError(Code.UNDEFINED_FEED_RATE)
    jog = _new_modes(line, modes)
    return Move(_target(line, jog, position), jog.feed)


def _new_modes(line: Line, modes: Modes) -> Modes:
    codes, values = line.codes, line.values
    units = {20: MM_PER_INCH, 21: 1.0}.get(codes.get("units", 0), modes.units)
    return Modes(
        motion=codes.get("motion", modes.motion),
        relative=codes["distance"] == 91 if "distance" in codes else modes.relative,
        units=units,
        feed=values["F"] * units if "F" in values else modes.feed,
        spindle=modes.spindle if line.spindle is None else line.spindle,
        speed=values.get("S", modes.speed),
    )


def _refuse_misfits(line: Line, modes: Modes) -> None:
    axes = line.axes()
    if line.once == 4 and "P" not in line.values:
        raise GrblError(Code.VALUE_WORD_MISSING)
    if axes and line.once == 28 and "motion" in line.codes:
        raise GrblError(Code.AXIS_COMMAND_CONFLICT)
    if line.once == 53 and modes.motion == 80:
        raise GrblError(Code.G53_INVALID_MOTION_MODE)
    if axes and line.once != 28 and modes.motion == 80:
        raise GrblError(Code.AXIS_WORDS_EXIST)
    moving = (axes and line.once not in (4, 28)) or "motion" in line.codes
    if moving and modes.motion == 1 and not modes.feed:
        raise GrblError(Code.UNDEFINED_FEED_RATE)
    if line.values.keys() & _LETTERS_OF_OTHERS or ("P" in line.values and line.once != 4) or (axes and line.once == 4):
        raise GrblError(Code.UNUSED_WORDS)


def _moves(line: Line, modes: Modes, position: Vector, home: Vector) -> tuple[Move, ...]:
    axes = line.axes()
    if line.once == 28:
        between = (Move(_target(line, modes, position), None),) if axes else ()
        return (*between, Move(home, None))
    if not axes or modes.motion == 80:
        return ()
    return (Move(_target(line, modes, position), None if modes.motion == 0 else modes.feed),)


def _target(line: Line, modes: Modes, position: Vector) -> Vector:
    """Work offsets are zero here, so that G53 differs from G54 only in being absolute whatever G91 says."""
    target = list(position)
    for place, value in line.axes().items():
        start = position[place] if modes.relative and line.once != 53 else 0.0
        target[place] = start + value * modes.units
    return tuple(target)
