"""The best border between old and new where they overlap in any shape: a minimum cut of a graph of pixels.

Blocks in rows and columns are cut by paths; a hole has borders of any shape (Kwatra and others, Graphcut textures,
2003).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LARGEST = 1 << 20
"""Capacities are whole numbers; the largest error between two pixels becomes this."""


def graph_cut_weight(error: F64, known: Mask, keeps_old: Mask, takes_new: Mask) -> F32:
    """Divide a block so that the errors summed along the border are least.

    Parameters
    ----------
    error : (B, B) squared difference of old and new, which counts only where old is known
    known : (B, B)
    keeps_old, takes_new : (B, B), where there is no choice

    Returns
    -------
    weight : (B, B), 1 where the new block is taken
    """
    side = error.shape[0]
    old_end, new_end = side * side, side * side + 1
    number = np.arange(side * side).reshape(side, side)
    one = np.concatenate([number[:, :-1].ravel(), number[:-1].ravel()])
    other = np.concatenate([number[:, 1:].ravel(), number[1:].ravel()])
    there = known.ravel().astype(np.float64)
    errors = error.ravel() * there
    costs = (errors[one] + errors[other]) * 2 / np.maximum(there[one] + there[other], 1)
    largest = float(costs.max(initial=0)) or 1.0
    # A cut that costs nothing would be anywhere; one unit a pixel makes it short.
    whole = 1 + np.rint(costs / largest * _LARGEST).astype(np.int32)
    endless = np.int32(np.iinfo(np.int32).max // 8)
    kept, taken = number[keeps_old], number[takes_new & ~keeps_old]
    rows = np.concatenate([one, other, np.full(len(kept), old_end), taken])
    columns = np.concatenate([other, one, kept, np.full(len(taken), new_end)])
    limits = np.concatenate([whole, whole, np.full(len(kept) + len(taken), endless, np.int32)])
    graph = csr_array((limits, (rows, columns)), shape=(side * side + 2,) * 2)
    left = graph - maximum_flow(graph, old_end, new_end).flow
    left.eliminate_zeros()
    reached = breadth_first_order(left, old_end, return_predecessors=False)
    weight = np.ones(side * side + 2, np.float32)
    weight[reached] = 0
    return weight[: side * side].reshape(side, side)
