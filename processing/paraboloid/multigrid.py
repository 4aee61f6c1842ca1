"""Solving Laplace's and Poisson's equation on a dual paraboloid map by multigrid.

Every second grid is half as fine, is again a dual paraboloid map, and takes the smooth part of the error off the finer
one; the first guess comes from the coarsest.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np
from scipy import ndimage

from processing.paraboloid.multigrid_kernels import Spans, furthest, gather, relax, relax_some, residual, spread
from processing.paraboloid.recombine import Recombination
from processing.paraboloid.seam import F64, I64, Grid, Mask, Reads, ghosts

_MOST_CYCLES = 40
_COARSEST = 8
_COARSEST_RELAXATIONS = 30
_SLOW = 0.5
"""Of the last cycle's change: more of it, and steps are combined from then on."""
_EDGE = 3
"""Texels from what is known or across the seam. Coarse grids know these edges badly, so that errors there are slow to
go; they are relaxed more often than the rest."""
_EDGE_RELAXATIONS = 6
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
    edges: tuple[I64, I64]
    """Free texels close to others, in the flattened grids; by the colours of the chessboard."""
    shares: F64
    """How far each texel's four of the finer grid are known."""

    @property
    def shape(self) -> tuple[int, int, int]:
        return self.free.shape[0], self.free.shape[1], self.free.shape[2]

    def relax(self, values: F64, source: F64, times: int = 1) -> None:
        for _ in range(times):
            for colour in (0, 1):
                self.ghosts.refresh(values)
                relax(values, source, self.free, self.spans, colour)
        self.ghosts.refresh(values)

    def relax_edges(self, values: F64, source: F64) -> None:
        for _ in range(_EDGE_RELAXATIONS):
            for places in self.edges:
                self.ghosts.refresh(values)
                relax_some(values.reshape(-1), source.reshape(-1), places, self.shape[-1])
        self.ghosts.refresh(values)

    def residual(self, values: F64, source: F64, missing: F64) -> None:
        residual(values, source, self.free, self.spans, missing)
        self.ghosts.refresh(missing)


@dataclass(frozen=True)
class _Room:
    """Planes of one level that a cycle works in; what is not free stays 0, so that they serve again and again."""

    missing: F64
    rest: F64
    correction: F64


def levels(grid: Grid, known: Mask) -> Iterator[Level]:
    """Yield the grids, finest first, as long as they have free texels.

    A coarse texel is free only where all of its four are, known ones across the seam included: a correction that
    reached beyond the hole would grow from cycle to cycle.
    """
    shares = known.astype(np.float64)
    while True:
        free = grid.own() & ~known
        level = Level(grid, free, _spans(free), ghosts(grid, _REACH), known, _edges(free), shares)
        yield level
        if grid.count <= _COARSEST or not free.any():
            return
        grid = _coarser(grid)
        shares = _shares(level, grid)
        known = (shares > 0) & grid.own()


def solve(levels: list[Level], values: F64, source: F64, tolerance: float) -> tuple[F64, float]:
    """Solve one channel from a first guess that was solved on the next coarser grid.

    Returns
    -------
    values : solved
    change : of the last cycle, as a share of the range of what is known; more than the tolerance where many cycles
        were not enough
    """
    given = values[levels[0].known]
    spread_of = float(np.ptp(given)) or float(np.abs(given).max()) or 1.0
    pyramid = [(values, source)]
    for finer, level in itertools.pairwise(levels):
        values, source = pyramid[-1]
        weighted = np.where(finer.known, values, 0)
        finer.ghosts.refresh(weighted)
        totals = _blocks(weighted, level.grid.side).sum(axis=-1)
        means = np.divide(totals, level.shares, out=np.zeros(level.shape), where=level.known)
        pyramid.append((means, np.where(level.free, _blocks(source, level.grid.side).sum(axis=-1), 0)))
    guess = pyramid[-1][0]
    guess[levels[-1].free] = given.mean()
    rooms = [_Room(*(np.zeros(level.shape) for _ in fields(_Room))) for level in levels]
    steps: Recombination | None = None
    change = np.inf
    for depth in reversed(range(len(levels))):
        level = levels[depth]
        if depth + 1 < len(levels):
            coarse, guess = guess, pyramid[depth][0]
            spread(coarse, level.free, level.spans, guess)
        level.ghosts.refresh(guess)
        before, change = np.empty_like(guess), np.inf
        for _ in range(_MOST_CYCLES if depth == 0 else 2):
            np.copyto(before, guess)
            _cycle(levels, rooms, depth, guess, pyramid[depth][1])
            last, change = change, furthest(guess, before, level.spans) / spread_of
            if change <= tolerance:
                break
            if depth == 0 and (steps or change > _SLOW * last):
                steps = steps or Recombination()
                missing = np.zeros(level.shape)
                residual(guess, pyramid[0][1], level.free, level.spans, missing)
                steps.improve(guess, missing)
    return guess, change


def _cycle(levels: list[Level], rooms: list[_Room], depth: int, values: F64, source: F64) -> None:
    """Improve values in place: smooth, correct from the coarser grid, smooth."""
    level = levels[depth]
    if depth + 1 == len(levels):
        level.relax(values, source, _COARSEST_RELAXATIONS)
        return
    level.relax(values, source)
    level.relax_edges(values, source)
    missing, coarser, room = rooms[depth].missing, levels[depth + 1], rooms[depth + 1]
    level.residual(values, source, missing)
    gather(missing, coarser.free, coarser.spans, room.rest)
    room.correction[:] = 0
    _cycle(levels, rooms, depth + 1, room.correction, room.rest)
    spread(room.correction, level.free, level.spans, values)
    level.ghosts.refresh(values)
    level.relax_edges(values, source)
    level.relax(values, source)


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


def _edges(free: Mask) -> tuple[I64, I64]:
    near = free & ndimage.binary_dilation(~free, np.ones((1, 3, 3)), iterations=_EDGE)
    places = np.flatnonzero(near)
    row, column = np.divmod(places % (free.shape[1] * free.shape[2]), free.shape[2])
    one = (row + column) % 2 == 0
    return places[one], places[~one]
