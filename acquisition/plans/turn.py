"""Angles of the turntable: a whole turn or a part of one, divided evenly."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from acquisition.plans.limits import FARTHEST_DEG, MOST_ALIKE, MOST_STEPS, check_range
from litrig.base.errors import InputError

WHOLE_TURN_DEG = 360.0
TABLE_SIZE = 128
"""Usual side of an AMC table (the AMC paper, section 4)."""


@dataclass(frozen=True)
class Turn:
    """Slices of a turn, S_k of them.

    Every angle is the slice's share of the range, computed from one origin: nothing accumulates. A whole turn ends
    where it began, so its slices leave out the end; a shorter range is spread from end to end, both shot.

    Attributes
    ----------
    slices : S_k
    start_deg : turntable angle of the first
    range_deg : over which they are spread, above 0 and up to 360
    repeats : how often the same angles are gone through, each time upwards
    closure : whether the first slice is shot again at the end: after a whole turn at start + 360°, else at the start
    table_size : S_i, side of the table that is to be made; for advice only
    """

    slices: int
    start_deg: float = 0.0
    range_deg: float = WHOLE_TURN_DEG
    repeats: int = 1
    closure: bool = False
    table_size: int = TABLE_SIZE

    def __post_init__(self) -> None:
        """Refuse what no turntable can do."""
        check_range("slices", self.slices, 1, MOST_STEPS, "64 to 512 are usual")
        check_range("start_deg", self.start_deg, -FARTHEST_DEG, FARTHEST_DEG)
        check_range("range_deg", self.range_deg, 0, WHOLE_TURN_DEG, "for more turns raise repeats")
        if self.range_deg == 0:
            raise InputError("range_deg: 0 turns nothing; give up to 360, the whole turn")
        check_range("repeats", self.repeats, 1, MOST_ALIKE)

    def __len__(self) -> int:
        """Return the number of angles, without the closure."""
        return self.slices * self.repeats

    def __iter__(self) -> Iterator[float]:
        """Go through the angles in degrees, without the closure."""
        steps = self.slices if self.is_whole else max(self.slices - 1, 1)
        for _ in range(self.repeats):
            for s in range(self.slices):
                yield self.start_deg + self.range_deg * s / steps

    @property
    def is_whole(self) -> bool:
        """Whether the slices close a turn."""
        return self.range_deg == WHOLE_TURN_DEG

    @property
    def closing_deg(self) -> float:
        """Where the closure is shot."""
        return self.start_deg + (WHOLE_TURN_DEG if self.is_whole else 0.0)

    def advice(self) -> str:
        """Compare the slices with the table's size; empty if S_k = 2 to 4 × S_i (the AMC paper, section 4.1)."""
        whole = self.slices * WHOLE_TURN_DEG / self.range_deg
        low, high = 2 * self.table_size, 4 * self.table_size
        if low <= whole <= high:
            return ""
        few = "fewer" if whole < low else "more"
        return (
            f"{whole:.0f} slices a turn are {few} than the {low} to {high} that suit a table of size {self.table_size} "
            "(2 to 4 × its side); half as many do for a material that looks the same turned by 180°"
        )

    def parameters(self) -> Mapping[str, Any]:
        """Return them as session.toml has them."""
        return asdict(self)
