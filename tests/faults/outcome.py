"""What a campaign asks of a fault's case, and what the case answers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scale:
    """How large a campaign is; `trials` of cases that repeat themselves."""

    trials: int


@dataclass(frozen=True)
class Outcome:
    """What came out.

    Attributes
    ----------
    trials : how often the fault was tried
    wrong : how often something wrong was accepted, lost or done
    detail : the figure, in words
    passed : whether the fault's goal is met
    """

    trials: int
    wrong: int
    detail: str
    passed: bool
