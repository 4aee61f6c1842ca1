"""What lies beyond the unit circle of a dual paraboloid map: it goes on across the seam, with the other half.

The texel at (u, v) with q = u² + v² > 1 is the direction that the other half has at (u, v)/q, and is a ghost: it is
read there bilinearly. Close to the circle the texels that it would be read from lie beyond the circle too, and two
ghosts would be read from each other. So a rim of less than a texel belongs to both halves, and stands by itself.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Floats = NDArray[np.floating]
Mask = NDArray[np.bool_]
MARGIN = 2
_RIM = 0.8
"""Texels; from 0.71 on no ghost is read from a ghost."""


@dataclass(frozen=True)
class Grid:
    """Square grids over both halves, with a margin of two texels: they hold the rim and its neighbours.

    Attributes
    ----------
    count : texels along a side, without the margin
    start, step : of texel centres; column c and row r stand at (u, −v) = (start + c·step, start + r·step)
    """

    count: int
    start: float
    step: float

    @property
    def side(self) -> int:
        """Texels along a side, with the margin."""
        return self.count + 2 * MARGIN

    def q(self) -> F64:
        """Return u² + v² of every texel, (side, side)."""
        along = self.start + self.step * np.arange(-MARGIN, self.count + MARGIN)
        squares: F64 = along**2 + along[:, None] ** 2
        return squares

    def own(self) -> Mask:
        """Tell which texels are no ghosts, (side, side)."""
        mask: Mask = np.sqrt(self.q()) <= 1 + _RIM * self.step
        return mask


@dataclass(frozen=True)
class Reads:
    """Texels, and where they are read on the other half.

    Attributes
    ----------
    targets : (G,) in the flattened grids of both halves, (2, side, side), front first
    sources : (G, 4) likewise
    weights : (G, 4), of sum 1
    """

    targets: I64
    sources: I64
    weights: F64

    def refresh(self, values: F64) -> None:
        """Read the targets in grids (2, side, side) anew, in place."""
        _refresh(values.reshape(-1), self.targets, self.sources, self.weights)


def map_grid(size: int) -> Grid:
    """Return the grid whose texels within the margin are those of a map of this size."""
    return Grid(size, 1 / size - 1, 2 / size)


def ghosts(grid: Grid, reach: float = np.inf) -> Reads:
    """Find the ghosts, up to so many texels from the circle; nearest first."""
    return across(grid, ~grid.own() & (np.sqrt(grid.q()) <= 1 + reach * grid.step))


def across(grid: Grid, which: Mask) -> Reads:
    """Tell where texels beyond the circle (side, side) are read on the other half; nearest to the circle first."""
    q = grid.q().ravel()
    beyond = np.flatnonzero(which)
    beyond = beyond[np.argsort(q[beyond], kind="stable")]
    # A place in the grid, through (u, v)/q; it lies within the circle, and all four texels within the margin.
    y, x = (
        ((grid.start + (at - MARGIN) * grid.step) / q[beyond] - grid.start) / grid.step + MARGIN
        for at in np.divmod(beyond, grid.side)
    )
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    along, down = x - left, y - top
    sources = np.stack([(top + j) * grid.side + left + i for j in (0, 1) for i in (0, 1)], axis=1)
    weights = np.stack([(1 - down) * (1 - along), (1 - down) * along, down * (1 - along), down * along], axis=1)
    half = grid.side**2
    return Reads(
        np.concatenate([beyond, beyond + half]), np.concatenate([sources + half, sources]), np.tile(weights, (2, 1))
    )


def bordered(front: Floats | Mask, back: Floats | Mask) -> F64:
    """Stack two planes (S, S) with a margin of zeros, (2, side, side)."""
    return np.pad(np.stack([front, back]).astype(np.float64), ((0, 0), (MARGIN, MARGIN), (MARGIN, MARGIN)))


@kernel
def _refresh(values: F64, targets: I64, sources: I64, weights: F64) -> None:
    for g in range(targets.size):
        total = 0.0
        for k in range(4):
            total += weights[g, k] * values[sources[g, k]]
        values[targets[g]] = total
