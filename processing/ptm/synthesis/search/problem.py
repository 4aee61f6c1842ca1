"""What is searched for, in what, and what counts as found: common to all strategies, which must agree on every pick."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from processing.ptm.synthesis.search.distance import squared_distances

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Mask = NDArray[np.bool_]

NO_IDS: I64 = np.zeros(0, np.int64)


@dataclass(frozen=True)
class Source:
    """Where blocks come from.

    Attributes
    ----------
    texture : (H, W, K) float32, the vectors whose distance counts
    guide : (H, W, G) float32, what is held against the guidance map; G = 0 without one
    allowed : (H − B + 1, W − B + 1), which blocks may be taken, by their upper left pixel; None for all
    """

    texture: F32
    guide: F32
    allowed: Mask | None = None


@dataclass(frozen=True)
class Target:
    """A block's place with what is known there.

    Attributes
    ----------
    values : (B, B, K) float32; only known pixels are looked at
    known : (B, B)
    guide : (B, B, G) float32, wanted all over the block
    banned : sorted numbers of candidates that must not be taken
    """

    values: F32
    known: Mask
    guide: F32
    banned: I64 = field(default_factory=lambda: NO_IDS)


@dataclass(frozen=True)
class Rule:
    """Which blocks are good enough: d ≤ max((1 + τ)·best, δ).

    With δ = 0 only copies would be good enough wherever the source goes on as the result does, for there best is 0.

    Attributes
    ----------
    tolerance : τ
    delta : δ, squared distance a pixel of the neighbourhood (Texture paper, section IV)
    """

    tolerance: float
    delta: float

    def threshold(self, best: float, known: Mask) -> float:
        """Return the largest distance that is good enough."""
        return max((1 + self.tolerance) * best, self.delta * int(known.sum()))


class Candidates:
    """All blocks of all sources, numbered: source by source, row by row, by their upper left pixels."""

    def __init__(self, sources: Sequence[Source], block_px: int) -> None:
        self.sources, self.block_px = tuple(sources), block_px
        self.shapes = tuple(
            (source.texture.shape[0] - block_px + 1, source.texture.shape[1] - block_px + 1) for source in sources
        )
        self.starts = np.cumsum([0, *(height * width for height, width in self.shapes)])
        """First number of each source, and the number of all."""
        allowed = [
            np.ones(height * width, bool) if source.allowed is None else source.allowed.ravel()
            for source, (height, width) in zip(self.sources, self.shapes, strict=True)
        ]
        self.allowed: Mask = np.concatenate(allowed)
        self.allowed_ids: I64 = np.flatnonzero(self.allowed)

    def place(self, number: int) -> tuple[int, int, int]:
        """Return source, row and column of one."""
        source = int(np.searchsorted(self.starts, number, side="right")) - 1
        y, x = divmod(number - int(self.starts[source]), self.shapes[source][1])
        return source, y, x

    def around(self, source: int, y: int, x: int, radius_px: int) -> I64:
        """Return the numbers of those within a square of a place, which may lie beyond the source's ends."""
        height, width = self.shapes[source]
        rows = np.arange(max(0, y - radius_px), min(height, y + radius_px + 1))
        columns = np.arange(max(0, x - radius_px), min(width, x + radius_px + 1))
        return np.asarray(self.starts[source] + (rows[:, None] * width + columns).ravel(), np.int64)

    def distances(self, ids: I64, target: Target, limit: float = np.inf) -> F64:
        """Return exact squared distances (N,) of candidates to a target; inf for those beyond a limit.

        The sums are made in float64 and in one order, whoever asks: this is what every strategy decides by.
        """
        result = np.full(len(ids), np.inf)
        bounds = np.searchsorted(ids, self.starts)
        for index, source in enumerate(self.sources):
            mine = slice(bounds[index], bounds[index + 1])
            if mine.start == mine.stop:
                continue
            rows, columns = np.divmod(ids[mine] - self.starts[index], self.shapes[index][1])
            result[mine] = squared_distances(
                source.texture, source.guide, rows, columns, target.values, target.guide, target.known, limit
            )
        return result


class Search(Protocol):
    """A way to find the good blocks; every one finds the same."""

    def matches(self, target: Target, rule: Rule) -> I64:
        """Return the numbers of all candidates that are good enough, in ascending order, never none."""
