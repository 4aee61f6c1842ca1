"""What a line of G-code means, given the lines before it. Nothing moves here.

G18, G19, G40, G49, G61, G91.1 are accepted since they change nothing without arcs. Arcs, probing, tool lengths and
inverse time have no use on a light arm and are answered with error:20.
"""

from dataclasses import dataclass, field, replace

from firmware_sim.grbl.eeprom import COORDINATE_SYSTEMS
from firmware_sim.grbl.errors import Code, GrblError
from firmware_sim.grbl.settings import AXES
from firmware_sim.grbl.words import Word, split_words
from firmware_sim.motion import Vector

MM_PER_INCH = 25.4

_GROUPS: dict[float, str] = {
    0: "motion", 1: "motion", 80: "motion", 17: "plane", 18: "plane", 19: "plane", 20: "units", 21: "units",
    40: "cutter", 49: "length", 54: "offset", 55: "offset", 56: "offset", 57: "offset", 58: "offset", 59: "offset",
    61: "path", 90: "distance", 91: "distance", 91.1: "arc distance", 94: "feed",
    4: "once", 10: "once", 28: "once", 28.1: "once", 30: "once", 30.1: "once", 53: "once", 92: "once", 92.1: "once",
}  # fmt: skip
_FRACTIONS_OF_OTHERS = {38.2, 38.3, 38.4, 38.5, 43.1, 59.1, 59.2, 59.3, 61.1, 90.1, 92.2, 92.3}
_M_GROUPS = {
    0: "flow", 1: "flow", 2: "flow", 30: "flow", 3: "spindle", 4: "spindle", 5: "spindle",
    7: "coolant", 8: "coolant", 9: "coolant",
}  # fmt: skip
_VALUE_LETTERS = set("FLNPST")
_LETTERS_OF_OTHERS = set("IJKR")
_MOVES_TO_PLACES = {28.0: "G28", 30.0: "G30"}
_STORES_PLACES = {28.1: "G28", 30.1: "G30"}
_TAKES_AXES = {10.0, 28.0, 30.0, 92.0}
"""Commands for which axis words are no motion."""


@dataclass(frozen=True)
class Line:
    """The words of a line, sorted: G codes and M codes by modal group, values."""

    codes: dict[str, float]
    m_codes: dict[str, int]
    values: dict[str, float]

    @property
    def once(self) -> float | None:
        return self.codes.get("once")

    def axes(self) -> dict[int, float]:
        return {place: self.values[axis] for place, axis in enumerate(AXES) if axis in self.values}


def sort_words(text: str, axes: str) -> Line:
    """Read a line and refuse what contradicts itself, whatever came before.

    Parameters
    ----------
    text : the filtered line
    axes : letters of the axes that there are

    Raises
    ------
    GrblError
        The first thing wrong with the line.
    """
    codes: dict[str, float] = {}
    m_codes: dict[str, int] = {}
    values: dict[str, float] = {}
    for word in split_words(text):
        if word.letter == "G":
            code = _known_code(word)
            if _GROUPS[code] in codes:
                raise GrblError(Code.MODAL_GROUP_VIOLATION)
            codes[_GROUPS[code]] = code
        elif word.letter == "M":
            m_code = _known_m_code(word)
            if _M_GROUPS[m_code] in m_codes:
                raise GrblError(Code.MODAL_GROUP_VIOLATION)
            m_codes[_M_GROUPS[m_code]] = m_code
        else:
            _add_value(values, word, axes)
    return Line(codes, m_codes, values)


def _known_code(word: Word) -> float:
    code = round(word.value, 3)
    if code in _GROUPS:
        return code
    if code == int(code) or code in _FRACTIONS_OF_OTHERS:
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    raise GrblError(Code.COMMAND_VALUE_NOT_INTEGER)


def _known_m_code(word: Word) -> int:
    if word.value != int(word.value):
        raise GrblError(Code.COMMAND_VALUE_NOT_INTEGER)
    if int(word.value) not in _M_GROUPS:
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    return int(word.value)


def _add_value(values: dict[str, float], word: Word, axes: str) -> None:
    if word.letter not in _VALUE_LETTERS | _LETTERS_OF_OTHERS | set(axes):
        raise GrblError(Code.UNSUPPORTED_COMMAND)
    if word.letter in values:
        raise GrblError(Code.WORD_REPEATED)
    if word.letter in "FSPNT" and word.value < 0:
        raise GrblError(Code.NEGATIVE_VALUE)
    if word.letter == "N" and word.value > 10_000_000:
        raise GrblError(Code.INVALID_LINE_NUMBER)
    values[word.letter] = word.value


@dataclass
class Modes:
    """What the lines before have set; `units` is 1 for G21 and 25.4 for G20."""

    motion: int = 0
    plane: int = 17
    relative: bool = False
    units: float = 1.0
    feed: float = 0.0
    spindle: int = 5
    speed: float = 0.0
    mist: bool = False
    flood: bool = False
    offset: int = 54
    tool: int = 0

    def describe(self) -> str:
        """Print the modes, as `$G` does."""
        distance, units = ("G91" if self.relative else "G90"), ("G21" if self.units == 1 else "G20")
        coolant = " ".join(code for code, on in (("M7", self.mist), ("M8", self.flood)) if on) or "M9"
        codes = f"G{self.motion} G{self.offset} G{self.plane} {units} {distance} G94 M{self.spindle} {coolant}"
        return f"[GC:{codes} T{self.tool} F{self.feed / self.units:.0f} S{self.speed:.0f}]\r\n"

    def at_program_end(self) -> "Modes":
        """Return the modes after M2 or M30."""
        return replace(
            self, motion=1, plane=17, relative=False, spindle=5, mist=False, flood=False, offset=54, feed=self.feed
        )


@dataclass(frozen=True)
class Move:
    """A straight way; `feed` None means as fast as the axes can."""

    target: Vector
    feed: float | None


@dataclass(frozen=True)
class Frame:
    """What coordinates count from: places in the EEPROM, and the shift of G92, which a reset forgets."""

    places: dict[str, Vector]
    shift: Vector

    def offset(self, modes: Modes) -> Vector:
        """Return machine coordinates of the work origin, the field WCO."""
        return tuple(a + b for a, b in zip(self.places[f"G{modes.offset}"], self.shift, strict=True))


@dataclass(frozen=True)
class Task:
    """What a line asks to be done, in this order; None or empty means: nothing of the kind."""

    output_changes: bool = False
    dwell_s: float | None = None
    stores: dict[str, Vector] = field(default_factory=dict)
    shift: Vector | None = None
    moves: tuple[Move, ...] = field(default=())
    flow: int | None = None


def interpret(line: Line, modes: Modes, position: Vector, frame: Frame) -> tuple[Task, Modes]:
    """Work out a line against the modes in force.

    Parameters
    ----------
    line : the sorted words
    modes : in force before the line
    position : machine coordinates where the moves planned so far end
    frame : of the coordinates

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
    changed = _output(after) != _output(modes) or (after.motion != modes.motion and after.spindle != 5)
    flow = line.m_codes.get("flow")
    stores, shift = _stored(line, after, position, frame)
    task = Task(
        output_changes=changed,
        dwell_s=line.values.get("P") if line.once == 4 else None,
        stores=stores,
        shift=shift,
        moves=_moves(line, after, position, frame),
        flow=flow,
    )
    return task, after


def interpret_jog(line: Line, modes: Modes, position: Vector, frame: Frame) -> Move:
    """Work out a `$J=` line, which keeps the modes as they are and says everything itself.

    Raises
    ------
    GrblError
        The line has other words than G20, G21, G53, G90, G91, axes, N and F, or lacks an axis or F.
    """
    allowed = {"units", "distance"} | ({"once"} if line.once == 53 else set())
    if line.codes.keys() - allowed or line.m_codes:
        raise GrblError(Code.INVALID_JOG_COMMAND)
    if line.values.keys() - set(AXES) - {"F", "N"}:
        raise GrblError(Code.UNUSED_WORDS)
    if not line.axes():
        raise GrblError(Code.NO_AXIS_WORDS)
    if not line.values.get("F"):
        raise GrblError(Code.UNDEFINED_FEED_RATE)
    jog = _new_modes(line, modes)
    return Move(_target(line, jog, position, frame), jog.feed)


def _output(modes: Modes) -> tuple[int, float, bool, bool]:
    return modes.spindle, modes.speed, modes.mist, modes.flood


def _new_modes(line: Line, modes: Modes) -> Modes:
    codes, values = line.codes, line.values
    units = {20.0: MM_PER_INCH, 21.0: 1.0}.get(codes.get("units", 0), modes.units)
    coolant = line.m_codes.get("coolant")
    return Modes(
        motion=int(codes.get("motion", modes.motion)),
        plane=int(codes.get("plane", modes.plane)),
        relative=codes["distance"] == 91 if "distance" in codes else modes.relative,
        units=units,
        feed=values["F"] * units if "F" in values else modes.feed,
        spindle=line.m_codes.get("spindle", modes.spindle),
        speed=values.get("S", modes.speed),
        mist=(modes.mist or coolant == 7) and coolant != 9,
        flood=(modes.flood or coolant == 8) and coolant != 9,
        offset=int(codes.get("offset", modes.offset)),
        tool=int(values.get("T", modes.tool)),
    )


def _refuse_misfits(line: Line, modes: Modes) -> None:
    axes = line.axes()
    if line.once == 4 and "P" not in line.values:
        raise GrblError(Code.VALUE_WORD_MISSING)
    if axes and line.once in _TAKES_AXES and "motion" in line.codes:
        raise GrblError(Code.AXIS_COMMAND_CONFLICT)
    if line.once == 10:
        _refuse_wrong_offset(line)
    if line.once == 92 and not axes:
        raise GrblError(Code.NO_AXIS_WORDS)
    if line.once == 53 and modes.motion == 80:
        raise GrblError(Code.G53_INVALID_MOTION_MODE)
    if axes and line.once not in _TAKES_AXES and modes.motion == 80:
        raise GrblError(Code.AXIS_WORDS_EXIST)
    moving = (axes and line.once not in _TAKES_AXES | {4}) or "motion" in line.codes
    if moving and modes.motion == 1 and not modes.feed:
        raise GrblError(Code.UNDEFINED_FEED_RATE)
    unused = line.values.keys() & _LETTERS_OF_OTHERS
    unused |= {"P"} & line.values.keys() if line.once not in (4, 10) else set()
    unused |= {"L"} & line.values.keys() if line.once != 10 else set()
    if unused or (axes and line.once in (4, 28.1, 30.1, 92.1)):
        raise GrblError(Code.UNUSED_WORDS)


def _refuse_wrong_offset(line: Line) -> None:
    if not line.axes():
        raise GrblError(Code.NO_AXIS_WORDS)
    if not {"P", "L"} <= line.values.keys():
        raise GrblError(Code.VALUE_WORD_MISSING)
    if int(line.values["P"]) > len(COORDINATE_SYSTEMS):
        raise GrblError(Code.UNSUPPORTED_COORDINATE_SYSTEM)
    if line.values["L"] not in (2, 20):
        raise GrblError(Code.UNSUPPORTED_COMMAND)


def _stored(line: Line, modes: Modes, position: Vector, frame: Frame) -> tuple[dict[str, Vector], Vector | None]:
    """Return places to be stored in the EEPROM, and the new shift of G92."""
    if line.once in _STORES_PLACES:
        return {_STORES_PLACES[line.once]: position}, None
    if line.once == 92.1:
        return {}, (0.0,) * len(position)
    if line.once == 92:
        system = frame.places[f"G{modes.offset}"]
        shift = list(frame.shift)
        for place, value in line.axes().items():
            shift[place] = position[place] - system[place] - value * modes.units
        return {}, tuple(shift)
    if line.once == 10:
        number = int(line.values["P"])
        name = COORDINATE_SYSTEMS[number - 1] if number else f"G{modes.offset}"
        origin = list(frame.places[name])
        for place, value in line.axes().items():
            here = position[place] - frame.shift[place] - value * modes.units
            origin[place] = value * modes.units if line.values["L"] == 2 else here
        return {name: tuple(origin)}, None
    return {}, None


def _moves(line: Line, modes: Modes, position: Vector, frame: Frame) -> tuple[Move, ...]:
    axes = line.axes()
    if line.once in _MOVES_TO_PLACES:
        goal = frame.places[_MOVES_TO_PLACES[line.once]]
        if not axes:
            return (Move(goal, None),)
        # Only the axes that the line names go on to the stored place.
        between = _target(line, modes, position, frame)
        return Move(between, None), Move(tuple(goal[i] if i in axes else between[i] for i in range(len(goal))), None)
    if not axes or modes.motion == 80 or line.once in _TAKES_AXES:
        return ()
    return (Move(_target(line, modes, position, frame), None if modes.motion == 0 else modes.feed),)


def _target(line: Line, modes: Modes, position: Vector, frame: Frame) -> Vector:
    target = list(position)
    offset = frame.offset(modes)
    for place, value in line.axes().items():
        start = offset[place]
        if line.once == 53:
            start = 0.0
        elif modes.relative:
            start = position[place]
        target[place] = start + value * modes.units
    return tuple(target)
