"""Solving Laplace's and Poisson's equation on a dual paraboloid map by multigrid.

Every second grid is half as fine, is again a dual paraboloid map, and takes the smooth part of the error off the finer
one; the first guess comes from the coarsest.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from processing.paraboloid.multigrid_kernels import Spans, gather, relax, residual, spread
from processing.paraboloid.seam import F64, Grid, Mask, Reads, ghosts

_MOST_CYCLES = 40
_COARSEST = 8
_RELAXATIONS = 2
_MOST_RELAXATIONS = 16
_SLOW = 0.5
"""Of the last cycle's change: more of it, and the next cycles relax more often."""
_REACH = 3.0
"""Texels beyond the circle that the solver reads."""


@dataclass(frozen=True)
class Level:
    """One grid of the hierarchy."""

    grid: Grid
    free: Mask
    spans: Spans
    ghosts: Reads
    known: Mask

    @property
    def shape(self) -> tuple[int, int, int]:
        return self.free.shape[0], self.free.shape[1], self.free.shape[2]

    def relax(self, values: F64, source: F64, times: int = 1) -> None:
        for _ in range(times):
            for colour in (0, 1):
                self.ghosts.refresh(values)
                relax(values, source, self.free, self.spans, colour)
        self.ghosts.refresh(values)

    def residual(self, values: F64, source: F64) -> F64:
        missing = np.zeros(self.shape)
        residual(values, source, self.free, self.spans, missing)
        self.ghosts.refresh(missing)
        return missing


def levels(grid: Grid, known: Mask) -> Iterator[Level]:
    """Yield the grids, finest first, as long as they have free texels.

    A coarse texel is free only where all of its four are, known ones across the seam included: a correction that
    reached beyond the hole would grow from cycle to cycle.
    """
    while True:
        free = grid.own() & ~known
        level = Level(grid, free, _spans(free), ghosts(grid, _REACH), known)
        yield level
        if grid.count <= _COARSEST or not free.any():
            return
        grid = _coarser(grid)
        known = (_shares(level, grid) > 0) & grid.own()


def solve(levels: list[Level], values: F64, source: F64, tolerance: float) -> F64:
    """Solve one channel from a first guess that was solved on the next coarser grid."""
    given = values[levels[0].known]
    spread_of = float(np.ptp(given)) or float(np.abs(given).max()) or 1.0
    pyramid = [(values, source)]
    for finer, level in itertools.pairwise(levels):
        values, source = pyramid[-1]
        weighted = np.where(finer.known, values, 0)
        finer.ghosts.refresh(weighted)
        shares = np.where(level.known, _shares(finer, level.grid), 0)
        means = np.where(level.known, _blocks(weighted, level.grid.side).sum(axis=-1), 0) / np.where(shares, shares, 1)
        pyramid.append((means, np.where(level.free, _blocks(source, level.grid.side).sum(axis=-1), 0)))
    guess = pyramid[-1][0]
    guess[levels[-1].free] = given.mean()
    for depth in reversed(range(len(levels))):
        level = levels[depth]
        if depth + 1 < len(levels):
            coarse, guess = guess, pyramid[depth][0]
            spread(coarse, level.free, level.spans, guess)
        level.ghosts.refresh(guess)
        times, last = _RELAXATIONS, np.inf
        for _ in range(_MOST_CYCLES if depth == 0 else 2):
            before = guess.copy()
            _cycle(levels, depth, guess, pyramid[depth][1], times)
            change = float(np.abs(guess - before).max())
            if change <= tolerance * spread_of:
                break
            # Ragged holes, and those of single texels, are worse on coarse grids.
            times = min(2 * times, _MOST_RELAXATIONS) if change > _SLOW * last else times
            last = change
    return guess


def _cycle(levels: list[Level], depth: int, values: F64, source: F64, times: int) -> None:
    """Improve values in place: smooth, correct from the coarser grid, smooth."""
    level = levels[depth]
    if depth + 1 == len(levels):
        level.relax(values, source, 30)
        return
    level.relax(values, source, times)
    missing = level.residual(values, source)
    coarser = levels[depth + 1]
    rest = np.zeros(coarser.shape)
    gather(missing, coarser.free, coarser.spans, rest)
    correction = np.zeros(coarser.shape)
    _cycle(levels, depth + 1, correction, rest, times)
    spread(correction, level.free, level.spans, values)
    level.ghosts.refresh(values)
    level.relax(values, source, times)


def _shares(level: Level, coarser: Grid) -> F64:
    """Add up how far the four texels in each of a coarser grid are known."""
    shares = level.known.astype(np.float64)
    level.ghosts.refresh(shares)
    total: F64 = _blocks(shares, coarser.side).sum(axis=-1)
    return total


def _coarser(grid: Grid) -> Grid:
    return Grid((grid.count + 1) // 2, grid.start + grid.step / 2, 2 * grid.step)


def _blocks(planes: F64, side: int) -> F64:
    """Bring the four texels that lie in each one of the coarser grid (2, side, side) to the last axis."""
    inner = np.zeros((2, 2 * side - 2, 2 * side - 2), planes.dtype)
    count = min(inner.shape[1], planes.shape[1])
    inner[:, :count, :count] = planes[:, :count, :count]
    four = np.stack([inner[:, r::2, c::2] for r in (0, 1) for c in (0, 1)], axis=-1)
    return np.pad(four, ((0, 0), (1, 0), (1, 0), (0, 0)))


def _spans(free: Mask) -> Spans:
    """Return the first free column and the one past the last, for each row (2, side, 2)."""
    any_free = free.any(axis=-1)
    first = np.where(any_free, free.argmax(axis=-1), 1)
    last = np.where(any_free, free.shape[-1] - free[..., ::-1].argmax(axis=-1), 1)
    return np.stack([first, last], axis=-1).astype(np.int64)
