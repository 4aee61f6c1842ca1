"""Where the time of a session went."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from acquisition.report.record import FrameLine, SessionRecord, wall_time

F64 = NDArray[np.float64]

PARTS = ("move", "settle", "expose", "save")
_ENDS, _BEGINNINGS = frozenset({"pause", "hold", "stop", "close"}), frozenset({"segment", "reopened"})


@dataclass(frozen=True)
class StepTimes:
    """The times of every frame, in the order of shooting.

    Attributes
    ----------
    steps : (N,) which step
    parts_s : (N, 4) move, settle, expose, save; not a number where the journal does not say. Saving goes on while the
        rig moves to the next pose, so that the parts may add up to more than the session took
    shooting_s : from each line to the next within an unbroken part of the session, added up
    wall_s : from the first line of the journal to its last, by the wall clock; None if the labels are no times
    """

    steps: tuple[int, ...]
    parts_s: F64
    shooting_s: float
    wall_s: float | None

    @property
    def medians_s(self) -> dict[str, float]:
        """The median of each part that is known."""
        return {part: float(np.nanmedian(column)) for part, column in self._known}

    @property
    def totals_s(self) -> dict[str, float]:
        """The sum of each part that is known."""
        return {part: float(np.nansum(column)) for part, column in self._known}

    @property
    def apart_s(self) -> float | None:
        """How long nothing was under way: pauses, holds, and until somebody resumed."""
        return None if self.wall_s is None else max(0.0, self.wall_s - self.shooting_s)

    @property
    def _known(self) -> list[tuple[str, F64]]:
        columns = zip(PARTS, self.parts_s.T, strict=True)
        return [(part, column) for part, column in columns if np.isfinite(column).any()]


def step_times(record: SessionRecord) -> StepTimes:
    """Gather them from the journal."""
    lines = [frame.line for frame in record.frames]
    parts_s = np.array([_parts_s(line) for line in lines], np.float64).reshape(-1, len(PARTS))
    first, last = (wall_time(record.entries[index].get("t")) for index in (0, -1))
    wall_s = None if first is None or last is None else (last - first).total_seconds()
    return StepTimes(tuple(line.step for line in lines), parts_s, _shooting_s(record), wall_s)


def _parts_s(line: FrameLine) -> Sequence[float]:
    known = [line.times_s.get(part, np.nan) for part in PARTS[:-1]]
    from_s = line.handed_over_s
    return [*known, np.nan if from_s is None else max(0.0, line.mono_ns / 1e9 - from_s)]


def _shooting_s(record: SessionRecord) -> float:
    """Add up the monotonic clock between lines, but not from an end to a new beginning."""
    total_s = 0.0
    for before, after in pairwise(record.entries):
        if before["ev"] not in _ENDS and after["ev"] not in _BEGINNINGS:
            total_s += max(0.0, (int(after.get("mono_ns", 0)) - int(before.get("mono_ns", 0))) / 1e9)
    return total_s
