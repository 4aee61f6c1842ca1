"""The wanted steps of a session with what became of each, in the order in which they are looked at."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

from acquisition.consistency import Suspect
from acquisition.plans import Step
from acquisition.report.record import Fate, Frame, SessionRecord
from litrig.base.capture_folder.capture import Role

Colour = tuple[int, int, int]
SHORT = 26


class Flag(Enum):
    """Why a person should look at a step; the first of several gives the frame its colour."""

    MISSING = ("missing", (128, 122, 114))
    RECALLED = ("called back", (226, 92, 74))
    SUSPECT = ("lit from elsewhere?", (214, 92, 190))
    REMARK = ("has a remark", (217, 167, 90))
    RETAKEN = ("taken again", (92, 184, 160))
    TRIES = ("several tries", (104, 156, 222))

    @property
    def label(self) -> str:
        """Say it in words."""
        return str(self.value[0])

    @property
    def colour(self) -> Colour:
        """Its colour, RGB."""
        red, green, blue = self.value[1]
        return (red, green, blue)


@dataclass(frozen=True)
class Cell:
    """One wanted step.

    Attributes
    ----------
    step : what was wanted
    frame : the one that counts, else the last that was shot; None if there is none
    flags : why to look at it, gravest first
    words : what to say of the gravest, in a few words
    """

    step: Step
    frame: Frame | None
    flags: tuple[Flag, ...]
    words: str

    @property
    def pose(self) -> str:
        """Tell the pose in a few characters."""
        return pose_words(self.step)


def cells_of(record: SessionRecord, suspects: Iterable[Suspect]) -> list[Cell]:
    """Return every wanted step, in the order of the plan."""
    shot: dict[int, list[Frame]] = {}
    for frame in record.frames:
        shot.setdefault(frame.line.step, []).append(frame)
    suspect_steps = {suspect.step: suspect for suspect in suspects}
    return [_cell(step, shot.get(step.step, []), suspect_steps.get(step.step)) for step in record.wanted]


def in_order_of_pose(cells: Iterable[Cell]) -> list[Cell]:
    """Sort by turntable angle; steps at the same angle, or without, stay in the order of the plan."""
    return sorted(cells, key=lambda cell: -1e9 if cell.step.angle_deg is None else cell.step.angle_deg)


def as_grid(cells: Sequence[Cell]) -> list[list[Cell | None]] | None:
    """Lay the frames of a product of slices and lights out, a row a slice; None if the session is no such product."""
    angles = sorted({cell.step.angle_deg for cell in cells if cell.step.angle_deg is not None})
    columns: dict[object, int] = {}
    for cell in cells:
        columns.setdefault(_column(cell.step), len(columns))
    if len(angles) < 2 or len({cell.step.aim for cell in cells} - {None}) < 2:
        return None
    if 2 * len(cells) < len(angles) * len(columns):
        return None  # hardly any slice has the lights of another
    grid: list[list[Cell | None]] = [[None] * len(columns) for _ in angles]
    rows = {angle_deg: row for row, angle_deg in enumerate(angles)}
    for cell in cells:
        if cell.step.angle_deg is not None:
            grid[rows[cell.step.angle_deg]][columns[_column(cell.step)]] = cell
    return grid


def pose_words(step: Step) -> str:
    """Tell a step's pose in a few characters."""
    parts = [] if step.role is Role.FRAME else [step.role.value]
    if step.angle_deg is not None:
        parts.append(f"{step.angle_deg:.4g}°")
    if step.aim is not None:
        parts.append(f"{step.aim.azimuth_deg:.0f}°/{step.aim.elevation_deg:.0f}°")
    if step.exposure_ev:
        parts.append(f"{step.exposure_ev:+g} EV")
    if step.repeat:
        parts.append(f"no. {step.repeat + 1}")
    return " ".join(parts)


def _column(step: Step) -> object:
    return (step.aim, step.exposure_ev, step.repeat)


def _cell(step: Step, frames: Sequence[Frame], suspect: Suspect | None) -> Cell:
    counting = next((frame for frame in frames if frame.fate is Fate.COUNTS), None)
    frame = counting or (frames[-1] if frames else None)
    said: dict[Flag, str] = {}
    if frame is None:
        said[Flag.MISSING] = "missing"
    elif counting is None:
        said[Flag.RECALLED] = "called back"
    if frame is not None:
        said |= _of_frame(frame, frames, suspect)
    first = next(iter(said), None)
    words = "" if first is None else said[first]
    return Cell(step, frame, tuple(said), words if len(words) <= SHORT else words[: SHORT - 1] + "…")


def _of_frame(frame: Frame, frames: Sequence[Frame], suspect: Suspect | None) -> Mapping[Flag, str]:
    said: dict[Flag, str] = {}
    if suspect is not None:
        said[Flag.SUSPECT] = f"lit from {suspect.looks_deg[0]:.0f}°/{suspect.looks_deg[1]:.0f}°?"
    if frame.line.remarks:
        said[Flag.REMARK] = frame.line.remarks[0]
    if len(frames) > 1:
        recalled = any(other.fate is Fate.RECALLED for other in frames)
        said[Flag.RETAKEN] = f"taken {len(frames)} times" if not recalled else "taken again, was called back"
    if frame.tries > 1:
        said[Flag.TRIES] = f"{frame.tries} tries"
    return said
