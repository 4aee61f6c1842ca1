"""Least squares for every pixel at once, over the codes as they were decoded."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]

# So many values of a few pictures, and as many sums a term, stay in the processor's nearest memory.
_TILE = 1024


@kernel
def solve(solver: F32, pictures: NDArray[Any], start: int, stop: int, sums: F32) -> None:
    """Multiply a fitting matrix by the values of all pictures.

    Parameters
    ----------
    solver : (T, N)
    pictures : (N, V) of any kind of number
    start, stop : which values
    sums : (T, stop − start), for the result
    """
    terms, count = solver.shape
    one, other = np.zeros(_TILE, np.float32), np.zeros(_TILE, np.float32)
    tile = np.zeros((terms, _TILE), np.float32)
    for first in range(start, stop, _TILE):
        width = min(_TILE, stop - first)
        tile[:] = 0
        # Two pictures at a time: the sums are fetched and stored half as often.
        for picture in range(0, count - 1, 2):
            _take(pictures[picture, first : first + width], one)
            _take(pictures[picture + 1, first : first + width], other)
            for term in range(terms):
                _add(solver[term, picture], one, solver[term, picture + 1], other, tile[term])
        if count % 2:
            _take(pictures[count - 1, first : first + width], one)
            for term in range(terms):
                _add(solver[term, count - 1], one, np.float32(0), one, tile[term])
        for term in range(terms):
            sums[term, first - start : first - start + width] = tile[term, :width]


@kernel
def _take(values: NDArray[Any], row: F32) -> None:
    for place in range(len(values)):
        row[place] = values[place]


@kernel
def _add(factor: np.float32, row: F32, other_factor: np.float32, other: F32, sums: F32) -> None:
    for place in range(_TILE):
        sums[place] += factor * row[place] + other_factor * other[place]
