"""Time as the drivers see it: monotonic, and replaceable in tests."""

import time
from typing import Protocol


class Clock(Protocol):
    """Where time comes from, and how it passes."""

    def now_s(self) -> float:
        """Return seconds since some fixed instant; the camera's time stamps count from the same one."""

    def sleep(self, seconds: float) -> None:
        """Wait."""


class MonotonicClock:
    """The machine's CLOCK_MONOTONIC, which no change of the wall clock moves."""

    def now_s(self) -> float:
        """Return the monotonic time."""
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        """Wait in real time; a signal handler may run meanwhile."""
        time.sleep(seconds)  # noqa: TID251  # the one place where time really passes
