"""What a campaign asks of a fault, and what comes out."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scale:
    """How often a fault is tried."""

    trials: int


@dataclass(frozen=True)
class Outcome:
    """What came of it."""

    trials: int
    wrong: int
    detail: str
    passed: bool
