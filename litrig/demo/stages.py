"""One progress for a job of many stages, with the time that each took."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from litrig.base.progress import Progress, Report

WHOLE = 100


@dataclass
class Stages:
    """Reports per cent of the whole, each stage by its share of the time that it is expected to take.

    Attributes
    ----------
    expected_s : seconds that each stage takes on two cores, in order; only their ratios matter
    report : where the whole's progress goes
    took_s : what each finished stage took
    """

    expected_s: Mapping[str, float]
    report: Report
    took_s: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[Report]:
        """Run one stage; yields where its own steps report to."""
        start_s = time.monotonic()
        self._tell(name, 0.0, "")
        yield lambda progress: self._tell(name, progress.done / max(progress.total, 1), progress.note or progress.job)
        self.took_s[name] = time.monotonic() - start_s
        self._tell(name, 1.0, "")

    def _tell(self, name: str, share: float, note: str) -> None:
        names = list(self.expected_s)
        before_s = sum(self.expected_s[earlier] for earlier in names[: names.index(name)])
        done = (before_s + min(share, 1.0) * self.expected_s[name]) / sum(self.expected_s.values())
        self.report(Progress("demo", int(WHOLE * done), WHOLE, f"{name}  {note}".rstrip()))
