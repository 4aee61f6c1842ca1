"""What a capture folder tells of its session, in whatever state it was left."""

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field, ValidationError

from acquisition.plans import Aim, Step
from acquisition.wanted import read_steps
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Entry, read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.verify import Verification, verify_capture
from litrig.base.config import LARGEST_TOML_BYTES
from litrig.base.directions import angle_between_deg, direction_from_angles
from litrig.base.errors import FormatError, LitrigError
from litrig.base.files import read_limited

Finite = Annotated[float, Field(allow_inf_nan=False)]


class Fate(Enum):
    """What became of a frame."""

    COUNTS = "counts"
    REPLACED = "taken again"
    RECALLED = "called back"


class FrameLine(BaseModel):
    """The line of a frame in the journal, as far as a report looks at it; earlier versions wrote less."""

    t: str = ""
    mono_ns: int = 0
    file: str
    step: int
    attempt: int = Field(default=1, alias="try")
    role: Role = Role.FRAME
    pose_goal: dict[str, Finite] = Field(default_factory=dict)
    pose_before: dict[str, Finite] | None = None
    pose_after: dict[str, Finite] | None = None
    light: tuple[Finite, Finite, Finite] | None = None
    exposure_ev: Finite = 0.0
    camera: dict[str, Any] = Field(default_factory=dict)
    exposed: dict[str, Finite] = Field(default_factory=dict)
    times_s: dict[str, Finite] = Field(default_factory=dict)
    handed_over_s: Finite | None = None
    checks: dict[str, Finite] = Field(default_factory=dict)
    remarks: list[str] = Field(default_factory=list)
    verdict: str = "good"


@dataclass(frozen=True)
class Frame:
    """A frame that was acknowledged.

    Attributes
    ----------
    line : what the journal says of it
    fate : whether it counts
    tries : how often its step was shot for it
    """

    line: FrameLine
    fate: Fate
    tries: int

    def error_deg(self, part: str, when: str) -> float | None:
        """Return how far a part stood from its pose; None if it was not moved, or is not known.

        Parameters
        ----------
        part : turntable or light
        when : before or after the exposure
        """
        goal, pose = self.line.pose_goal, self.line.pose_before if when == "before" else self.line.pose_after
        names = ("angle_deg",) if part == "turntable" else ("azimuth_deg", "elevation_deg")
        if pose is None or not all(name in goal and name in pose for name in names):
            return None
        if part == "turntable":
            return abs(pose["angle_deg"] - goal["angle_deg"])
        return angle_between_deg(*(direction_from_angles(*(at[name] for name in names)) for at in (goal, pose)))


@dataclass(frozen=True)
class SessionRecord:
    """A session as its folder has it.

    Attributes
    ----------
    folder : where it lies
    object_id, operator : what was shot, and by whom; empty if nobody said
    settings : session.toml; empty if it cannot be read
    wanted : the steps of the plan, in its order
    entries : the journal
    frames : every acknowledged frame, in the order of shooting
    verification : what a look at every file found
    findings : what is wrong with the folder, an open bag aside
    """

    folder: Path
    object_id: str
    operator: str
    settings: Mapping[str, Any]
    wanted: tuple[Step, ...]
    entries: tuple[Entry, ...]
    frames: tuple[Frame, ...]
    verification: Verification
    findings: tuple[str, ...]

    @property
    def counting(self) -> dict[int, Frame]:
        """The frame of each step that has a good one."""
        return {frame.line.step: frame for frame in self.frames if frame.fate is Fate.COUNTS}

    @property
    def missing(self) -> list[Step]:
        """The steps without a good frame."""
        counting = self.counting
        return [step for step in self.wanted if step.step not in counting]

    @property
    def kind(self) -> str:
        """The kind of the plan; empty if it is not known."""
        plan = self.settings.get("plan")
        return str(plan.get("kind", "")) if isinstance(plan, Mapping) else ""

    def of(self, event: str) -> list[Entry]:
        """Return the journal's entries of one kind."""
        return [entry for entry in self.entries if entry["ev"] == event]


def read_record(folder: Path) -> SessionRecord:
    """Read it.

    Raises
    ------
    InputError, FormatError
        It is no capture folder, or its journal is damaged, or says nothing of a session.
    """
    verification = verify_capture(folder)
    journal = folder / layout.JOURNAL
    entries = read_journal(journal)
    if not entries:
        raise FormatError(f"{journal}: holds no whole line; nothing was shot, capture anew")
    findings = list(verification.findings) if verification.closed else _without_open_bag(verification.findings)
    frames = _frames(entries, journal)
    settings: Mapping[str, Any] = {}
    wanted: Sequence[Step] = ()
    try:
        settings = _read_settings(folder)
    except LitrigError as error:
        findings.append(str(error))
    try:
        wanted = read_steps(folder)
    except LitrigError as error:
        findings.append(str(error))
        wanted = _steps_of(frames)
    session = settings.get("session", {})
    return SessionRecord(
        folder=folder,
        object_id=str(entries[0].get("object") or session.get("object") or folder.resolve().name),
        operator=str(session.get("operator") or ""),
        settings=settings,
        wanted=tuple(wanted),
        entries=tuple(entries),
        frames=frames,
        verification=verification,
        findings=tuple(dict.fromkeys(findings)),
    )


def wall_time(entry_time: object) -> datetime | None:
    """Read the label of an entry's time; None if it is none."""
    with suppress(ValueError):
        time = datetime.fromisoformat(str(entry_time))
        return time if time.tzinfo is not None else None
    return None


def moment(entry_time: object) -> str:
    """Write the label of an entry's time as people do, to the second."""
    time = wall_time(entry_time)
    return str(entry_time or "") if time is None else f"{time.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"


def _frames(entries: Sequence[Entry], journal: Path) -> tuple[Frame, ...]:
    counting = {id(entry) for entry in good_frames(entries)}
    recalled: set[int] = set()
    latest: dict[int, int] = {}
    retries: dict[int, int] = {}
    frames: list[tuple[FrameLine, int, int]] = []
    for number, entry in enumerate(entries, 1):
        if entry["ev"] == "retry" and isinstance(entry.get("step"), int):
            retries[entry["step"]] = retries.get(entry["step"], 0) + 1
        elif entry["ev"] == "recall":
            recalled |= {latest[step] for step in entry["steps"] if step in latest}
        elif entry["ev"] == "frame":
            line = _line(entry, f"{journal}, line {number}")
            latest[line.step] = id(entry)
            frames.append((line, id(entry), 1 + retries.pop(line.step, 0)))
    return tuple(
        Frame(
            line,
            Fate.COUNTS if which in counting else Fate.RECALLED if which in recalled else Fate.REPLACED,
            max(tries, line.attempt),
        )
        for line, which, tries in frames
    )


def _line(entry: Entry, place: str) -> FrameLine:
    try:
        return FrameLine.model_validate(entry)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise FormatError(f"{place}: {key}: {first['msg']}; restore the folder from a copy") from error


def _read_settings(folder: Path) -> Mapping[str, Any]:
    path = folder / layout.SESSION
    try:
        settings = tomllib.loads(read_limited(path, LARGEST_TOML_BYTES).decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatError(f"{path}: is no TOML ({error}); restore it from a copy") from error
    if not all(isinstance(settings.get(name, {}), Mapping) for name in ("session", "plan", "rig")):
        raise FormatError(f"{path}: session, plan and rig must be tables; restore it from a copy")
    return settings


def _steps_of(frames: Iterable[Frame]) -> list[Step]:
    """Make up a plan from what was shot, where the plan is gone."""
    steps = {}
    for frame in frames:
        line, goal = frame.line, frame.line.pose_goal
        has_aim = "azimuth_deg" in goal and "elevation_deg" in goal
        aim = Aim(goal["azimuth_deg"], goal["elevation_deg"], int(goal.get("lamp", 0))) if has_aim else None
        steps[line.step] = Step(line.step, line.role, goal.get("angle_deg"), aim, line.exposure_ev)
    return [steps[step] for step in sorted(steps)]


def _without_open_bag(findings: Iterable[str]) -> list[str]:
    """Leave out that an open session is no complete bag: its state says so."""
    return [finding for finding in findings if not finding.startswith("the session was not closed")]
