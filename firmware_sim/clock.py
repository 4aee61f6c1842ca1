"""Time comes from outside, so that a state machine can be taken through an hour in no time."""

import time
from collections.abc import Callable

Clock = Callable[[], float]
"""Seconds from an arbitrary start; never goes back."""


def monotonic_s() -> float:
    """Seconds of CLOCK_MONOTONIC: the clock that V4L2 stamps its buffers with."""
    return time.clock_gettime(time.CLOCK_MONOTONIC)
