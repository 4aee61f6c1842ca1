"""Progress drawn for people: a bar with the time left on a terminal, plain lines elsewhere. For commands only."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import IO, Any, Protocol, cast

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bars

from litrig.base.progress import Progress

SECONDS_BETWEEN_LINES = 5.0


class Reporter(Protocol):
    """A place to send progress to, where a person may be asked something."""

    def __call__(self, progress: Progress) -> None:
        """Draw it."""

    def ask(self, what: str) -> bool:
        """Say something, and wait until it is confirmed; False if nobody can."""


@contextmanager
def reporting() -> Iterator[Reporter]:
    """Yield a place to send progress to; it is drawn on standard error, so that answers can be piped."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield PlainLines()
        return
    columns = [
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.fields[note]}", style="dim"),
    ]
    calm = Console(file=cast(IO[str], _StaysCalm(sys.stderr)))
    with Bars(*columns, console=calm) as bars:
        yield _BarPerJob(bars)


class _StaysCalm:
    """A stream that goes quiet when it cannot be written: a terminal that is closed must not end the job in it."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


class _BarPerJob:
    def __init__(self, bars: Bars) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, progress: Progress) -> None:
        if progress.job not in self._tasks:
            self._tasks[progress.job] = self._bars.add_task(progress.job, total=progress.total, note="")
        self._bars.update(self._tasks[progress.job], completed=progress.done, total=progress.total, note=progress.note)

    def ask(self, what: str) -> bool:
        """Ask between two drawings of the bar."""
        self._bars.stop()
        try:
            return _confirmed(what)
        finally:
            self._bars.start()


class PlainLines:
    """A line when a job starts, every few seconds while it runs, and when it ends.

    When a line cannot be written, it goes quiet: no job dies because nobody hears of it.
    """

    def __init__(self) -> None:
        self._job = ""
        self._started_s = self._last_line_s = 0.0
        self._quiet = False

    def __call__(self, progress: Progress) -> None:
        """Print the step if it is time to."""
        if self._quiet:
            return
        now_s = time.monotonic()
        if progress.job != self._job:
            self._job, self._started_s, self._last_line_s = progress.job, now_s, 0.0
        if progress.done < progress.total and now_s - self._last_line_s < SECONDS_BETWEEN_LINES:
            return
        self._last_line_s = now_s
        left = _time_left(progress, now_s - self._started_s)
        note = f"  {progress.note}" if progress.note else ""
        try:
            sys.stderr.write(f"{progress.job}: {progress.done}/{progress.total}{left}{note}\n")
            sys.stderr.flush()
        except OSError:
            self._quiet = True

    def ask(self, what: str) -> bool:
        """Ask on a line."""
        return _confirmed(what)


def _confirmed(what: str) -> bool:
    try:
        sys.stderr.write(f"{what}: ")
        sys.stderr.flush()
        return bool(sys.stdin.readline())
    except OSError:  # nobody is there any more
        return False


def _time_left(progress: Progress, elapsed_s: float) -> str:
    if not 0 < progress.done < progress.total or elapsed_s < 1:
        return ""
    return f", {elapsed_s / progress.done * (progress.total - progress.done):.0f} s left"
