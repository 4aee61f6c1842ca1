"""How a new block is joined to what is there: blended across the overlap, or cut along the path of least error."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.ptm.synthesis.layout import Edges
from processing.ptm.synthesis.settings import Join

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def new_weight(join: Join, old: F32, new: F32, compared: int, edges: Edges) -> F32:
    """Return how much of the new block every pixel takes, (B, B), 0 to 1.

    Parameters
    ----------
    old, new : (B, B, P); the first `compared` planes decide where a cut runs
    edges : where old is known
    """
    if join == "blend":
        return _ramps(old.shape[0], edges)
    difference = (old[..., :compared] - new[..., :compared]).astype(np.float64)
    return cut_weight(np.einsum("ijk,ijk->ij", difference, difference), edges)


def cut_weight(error: F64, edges: Edges) -> F32:
    """Cut every overlap along the path of least summed error (Efros, Freeman, Image quilting, 2001): 0 or 1, (B, B)."""
    weight = np.ones(error.shape, np.float32)
    # Each side is turned to the left, its overlap along the first columns; views, so that the weight is written to.
    for width, turned_error, turned_weight in (
        (edges.left, error, weight),
        (edges.right, error[:, ::-1], weight[:, ::-1]),
        (edges.top, error.T, weight.T),
        (edges.bottom, error[::-1].T, weight[::-1].T),
    ):
        if width:
            path = least_path(np.ascontiguousarray(turned_error[:, :width]))
            turned_weight[:, :width][np.arange(width) < path[:, None]] = 0
    return weight


@kernel
def least_path(error: F64) -> NDArray[np.int64]:
    """Find the path down an overlap with the least sum of errors, one pixel a row, at most one column aside a row.

    Parameters
    ----------
    error : (B, O)

    Returns
    -------
    columns : (B,), the path's; old is kept before it
    """
    rows, columns = error.shape
    sums = error.copy()
    for i in range(1, rows):
        for j in range(columns):
            least = sums[i - 1, j]
            if j > 0:
                least = min(least, sums[i - 1, j - 1])
            if j + 1 < columns:
                least = min(least, sums[i - 1, j + 1])
            sums[i, j] += least
    path = np.zeros(rows, np.int64)
    path[rows - 1] = np.argmin(sums[rows - 1])
    for i in range(rows - 2, -1, -1):
        below = path[i + 1]
        path[i] = below
        for j in (below - 1, below + 1):
            if 0 <= j < columns and sums[i, j] < sums[i, path[i]]:
                path[i] = j
    return path


def _ramps(side: int, edges: Edges) -> F32:
    weight = np.ones((side, side), np.float32)
    for width, turned in (
        (edges.left, weight),
        (edges.right, weight[:, ::-1]),
        (edges.top, weight.T),
        (edges.bottom, weight[::-1].T),
    ):
        ramp = (np.arange(width, dtype=np.float32) + 1) / (width + 1)
        turned[:, :width] = np.minimum(turned[:, :width], ramp)
    return weight
