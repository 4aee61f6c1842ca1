"""The line of a frame in the journal: what readers need of it, checked before they rely on it."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, Field, ValidationError

from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Entry
from litrig.base.errors import FormatError

Finite = Annotated[float, Field(allow_inf_nan=False)]


class _Pose(BaseModel):
    angle_deg: Finite | None = None


class _FrameLine(BaseModel):
    """The keys that a frame is picked and read by; others are for people."""

    step: int
    file: str
    sha256: str
    role: Role = Role.FRAME
    pose_goal: _Pose | None = None
    pose_after: _Pose | None = None
    exposure_ev: Finite = 0.0
    light: tuple[Finite, Finite, Finite] | None = None


class _RecallLine(BaseModel):
    """Frames that were good and count no longer."""

    steps: list[int]
    files: list[str] = []


_MODELS: dict[str, type[BaseModel]] = {"frame": _FrameLine, "recall": _RecallLine}


def check_frame_lines(entries: Iterable[Entry], journal: Path) -> None:
    """Refuse a journal whose lines are whole and yet do not say what a line must say.

    Raises
    ------
    FormatError
        A line has no event, or the line of a frame lacks a key or has a value of the wrong kind.
    """
    for number, entry in enumerate(entries, 1):
        if not isinstance(entry.get("ev"), str):
            raise FormatError(f"{journal}, line {number}: names no event (ev); restore the folder from a copy")
        if model := _MODELS.get(entry["ev"]):
            _check(model, entry, f"{journal}, line {number}")


def _check(model: type[BaseModel], entry: Entry, place: str) -> None:
    try:
        model.model_validate(entry)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"])
        raise FormatError(f"{place}: {key}: {first['msg']}; restore the folder from a copy") from error
