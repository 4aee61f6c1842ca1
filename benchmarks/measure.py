"""Timing two ways of doing the same thing in turn, so that the machine's moods fall on both."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Comparison:
    """A row of the table.

    Attributes
    ----------
    what : what was done
    ours, other : what was compared
    ratio : median over the rounds of our time by the other's
    spread : smallest and largest ratio
    ours_s : median of our time
    goal : what the ratio should be, in words
    """

    what: str
    ours: str
    other: str
    ratio: float
    spread: tuple[float, float]
    ours_s: float
    goal: str


def compare(
    what: str,
    ours: tuple[str, Callable[[], object]],
    other: tuple[str, Callable[[], object]],
    *,
    goal: str = "",
    rounds: int = 7,
    clock: Callable[[], float] = time.perf_counter,
) -> Comparison:
    """Run both in turn, after a warm-up, and compare round by round.

    Parameters
    ----------
    clock : tells seconds; `time.process_time` those that all threads of the process compute
    """
    ours[1]()
    other[1]()
    pairs = [(_seconds(ours[1], clock), _seconds(other[1], clock)) for _ in range(rounds)]
    ratios = [first / second for first, second in pairs]
    return Comparison(
        what,
        ours[0],
        other[0],
        statistics.median(ratios),
        (min(ratios), max(ratios)),
        statistics.median(first for first, _ in pairs),
        goal,
    )


def table(rows: Sequence[Comparison]) -> str:
    """Write rows as Markdown."""
    headings = ("what", "ours", "beside", "ours / beside, median (min–max)", "ours, s", "goal")
    head = f"| {' | '.join(headings)} |\n|{' --- |' * len(headings)}"
    lines = [
        f"| {row.what} | {row.ours} | {row.other} | {row.ratio:.2f} ({row.spread[0]:.2f}–{row.spread[1]:.2f}) | "
        f"{row.ours_s:.3g} | {row.goal} |"
        for row in rows
    ]
    return "\n".join([head, *lines])


def peak_bytes() -> int:
    """Read the high-water mark of this program's memory; getrusage's is inherited from whoever started it."""
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) * 1024


def _seconds(action: Callable[[], object], clock: Callable[[], float]) -> float:
    start_s = clock()
    action()
    return clock() - start_s
