"""Tables of numbers with equal rows, and sums over groups of rows; made for millions of rows."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


def unique_rows(values: NDArray[np.floating] | NDArray[np.integer]) -> tuple[F64, I64]:
    """Return the different rows in order, and for each old row the number of its new one."""
    # Adding 0 makes −0 and 0 the same.
    table = np.asarray(values, np.float64) + 0.0
    if not len(table):
        return table, np.zeros(0, np.int64)
    order = np.lexsort(table.T[::-1])
    ordered = table[order]
    first = np.ones(len(table), np.bool_)
    first[1:] = np.any(ordered[1:] != ordered[:-1], axis=1)
    numbers = np.zeros(len(table), np.int64)
    numbers[order] = np.cumsum(first) - 1
    return ordered[first], numbers


def sums_by(groups: I64, vectors: F64, count: int) -> F64:
    """Sum up vectors (N, 3) by the number of their group, (count, 3)."""
    return np.stack([np.bincount(groups, vectors[:, axis], count) for axis in range(3)], axis=1)
