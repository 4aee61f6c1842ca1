"""What a session wants, and what of it is missing."""

import json
from collections.abc import Container, Iterable
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from acquisition.plans import MOST_STEPS, Step
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.bag import sha256_of
from litrig.base.capture_folder.journal import Entry, known_harm
from litrig.base.capture_folder.reader import good_frames
from litrig.base.errors import FormatError, InputError
from litrig.base.files import read_limited, resolve_inside

LARGEST_PLAN_BYTES = 2000 * MOST_STEPS
_STEP = TypeAdapter(Step)


def read_steps(folder: Path) -> list[Step]:
    """Read the wanted steps of a session, in the order of its plan.

    Raises
    ------
    InputError, FormatError
        There is no session, or no plan, or a line of it is no step.
    """
    if not (folder / layout.JOURNAL).is_file():
        raise InputError(
            f"{folder}: holds no session ({layout.JOURNAL} is missing): it ended before anything was shot, or is "
            "another folder; capture anew, under another name"
        )
    path = folder / layout.PLAN
    steps = []
    for number, line in enumerate(read_limited(path, LARGEST_PLAN_BYTES).splitlines(), 1):
        try:
            steps.append(_STEP.validate_python(json.loads(line)))
        except (ValidationError, ValueError) as error:
            reason = error.errors(include_url=False)[0]["msg"] if isinstance(error, ValidationError) else str(error)
            raise FormatError(f"{path}, line {number}: is no step ({reason}); restore the file from a copy") from error
    if len({step.step for step in steps}) != len(steps):
        raise FormatError(f"{path}: has a step twice; restore the file from a copy")
    return steps


def missing_steps(wanted: Iterable[Step], entries: Iterable[Entry], harmed: Container[str]) -> list[Step]:
    """Return the steps without a good frame that is on the disk as it was shot."""
    present = {entry["step"] for entry in good_frames(entries) if entry["file"] not in harmed}
    return [step for step in wanted if step.step not in present]


def harmed_files(folder: Path, entries: Iterable[Entry]) -> list[str]:
    """Name the files of frames that are gone, or not as they were shot, and that no earlier part knew to be so."""
    frames = [entry for entry in entries if entry["ev"] == "frame"]
    known = known_harm(entries)
    return [entry["file"] for entry in frames if entry["file"] not in known and not _is_whole(folder, entry)]


def _is_whole(folder: Path, entry: Entry) -> bool:
    path = resolve_inside(folder, entry["file"])
    return path.is_file() and path.stat().st_size == entry["bytes"] and sha256_of(path) == entry["sha256"]
