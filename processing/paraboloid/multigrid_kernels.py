"""Loops of the multigrid solver, over one channel of both halves with their margins, (2, side, side).

Equations are Σ neighbours − 4·f = s at texels that are `free`; texels beyond the rim are `seam.ghosts`.
"""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.paraboloid.seam import F64, I64, Mask

Spans = NDArray[np.int64]


@kernel
def relax(values: F64, source: F64, free: Mask, spans: Spans, colour: int) -> None:
    """Solve each free texel of one colour of the chessboard for itself."""
    for half in range(values.shape[0]):
        for row in range(1, values.shape[1] - 1):
            first = spans[half, row, 0]
            for column in range(first + (first + row + colour) % 2, spans[half, row, 1], 2):
                if free[half, row, column]:
                    values[half, row, column] = 0.25 * (
                        values[half, row - 1, column]
                        + values[half, row + 1, column]
                        + values[half, row, column - 1]
                        + values[half, row, column + 1]
                        - source[half, row, column]
                    )


@kernel
def relax_some(values: F64, source: F64, places: I64, side: int) -> None:
    """Solve texels at places in flattened grids, each for itself."""
    for at in places:
        values[at] = 0.25 * (values[at - side] + values[at + side] + values[at - 1] + values[at + 1] - source[at])


@kernel
def furthest(values: F64, before: F64, spans: Spans) -> float:
    """Return the largest change; what is no number is infinitely far."""
    most = 0.0
    for half in range(values.shape[0]):
        for row in range(1, values.shape[1] - 1):
            for column in range(spans[half, row, 0], spans[half, row, 1]):
                change = abs(values[half, row, column] - before[half, row, column])
                if not change <= most:
                    most = change if change > most else np.inf
    return most


@kernel
def residual(values: F64, source: F64, free: Mask, spans: Spans, out: F64) -> None:
    """Write what is missing in each equation."""
    for half in range(values.shape[0]):
        for row in range(1, values.shape[1] - 1):
            for column in range(spans[half, row, 0], spans[half, row, 1]):
                if free[half, row, column]:
                    out[half, row, column] = (
                        source[half, row, column]
                        + 4 * values[half, row, column]
                        - values[half, row - 1, column]
                        - values[half, row + 1, column]
                        - values[half, row, column - 1]
                        - values[half, row, column + 1]
                    )


@kernel
def gather(fine: F64, free: Mask, spans: Spans, coarse: F64) -> None:
    """Add up the four texels that lie in each free one of the next coarser grid."""
    side = fine.shape[1]
    for half in range(coarse.shape[0]):
        for row in range(1, coarse.shape[1] - 1):
            for column in range(spans[half, row, 0], spans[half, row, 1]):
                total = 0.0
                if free[half, row, column]:
                    for r in range(2 * row - 2, min(2 * row, side)):
                        for c in range(2 * column - 2, min(2 * column, side)):
                            total += fine[half, r, c]
                coarse[half, row, column] = total


@kernel
def spread(coarse: F64, free: Mask, spans: Spans, fine: F64) -> None:
    """Add the coarser grid, read bilinearly, to the free texels."""
    for half in range(fine.shape[0]):
        for row in range(1, fine.shape[1] - 1):
            near = row // 2 + 1
            far = near + 1 if row % 2 else near - 1
            for column in range(spans[half, row, 0], spans[half, row, 1]):
                if free[half, row, column]:
                    beside = column // 2 + 1
                    away = beside + 1 if column % 2 else beside - 1
                    fine[half, row, column] += (
                        9 * coarse[half, near, beside]
                        + 3 * (coarse[half, near, away] + coarse[half, far, beside])
                        + coarse[half, far, away]
                    ) / 16
