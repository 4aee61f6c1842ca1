"""Progress as data: libraries yield it, commands draw it."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """One step of a longer job has ended.

    Attributes
    ----------
    job : what is being done, in a few words; the same for all steps of one job
    done, total : steps so far and in all
    note : what this step has to say for itself (may be empty)
    """

    job: str
    done: int
    total: int
    note: str = ""


Report = Callable[[Progress], None]


def silent(_: Progress) -> None:
    """Take no notice: the default where nobody watches."""
