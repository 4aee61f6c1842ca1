"""Which triangles meet at an edge."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

Bools = NDArray[np.bool_]
I64 = NDArray[np.int64]


def edge_neighbours(corners: I64) -> tuple[I64, I64, I64, I64]:
    """Pair the corners of triangles that share an edge, at both of its ends.

    Parameters
    ----------
    corners : (T, 3), the place of each corner

    Returns
    -------
    one_low, other_low, one_high, other_high : (E,) numbers of corners, counted triangle by triangle: at either end of
        an edge, that of one triangle and that of the other
    """
    start = np.arange(corners.size)
    end = start.reshape(-1, 3)[:, [1, 2, 0]].reshape(-1)
    place = corners.reshape(-1)
    # Every edge from its lower place to its higher one, so that both of its triangles name its ends alike.
    swapped = place[start] > place[end]
    low, high = np.where(swapped, end, start), np.where(swapped, start, end)
    order = np.lexsort((place[high], place[low]))
    low, high = low[order], high[order]
    same = np.flatnonzero((place[low[1:]] == place[low[:-1]]) & (place[high[1:]] == place[high[:-1]]))
    return low[same], low[same + 1], high[same], high[same + 1]


def joined(one: I64, other: I64, count: int) -> I64:
    """Tell of `count` things which group they are in, (count,), where pairs join them."""
    links = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(count, count))
    groups: I64 = connected_components(links, directed=False)[1].astype(np.int64)
    return groups
