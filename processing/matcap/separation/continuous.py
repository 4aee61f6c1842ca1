"""The brightest shading by a single direction that stays under a picture, at each pixel (one channel).

The MatCap paper's opening by a clamped cosine (section 4.1) with light directions between pixels, too:
opening(p) = max m·n_p over m with m·n_q ≤ v_q for all q and m_z ≥ 0. It does not depend on the resolution, and gives a
Lambert sphere back as it is, where the opening over pixels loses light.

Few pixels hold shadings down. They are found by taking some, and adding those that are violated most, part by part of
the disc, until none is.
"""

import numpy as np
from numpy.typing import NDArray

from processing.matcap.separation.envelope import shadings_under
from processing.matcap.separation.pixel_tree import PixelTree
from processing.matcap.separation.support import support

F64 = NDArray[np.float64]
Integers = NDArray[np.int64]

_FIRST, _PARTS = 2000, 1000
_ROUNDING = 1e-9
_PATIENT_ROUNDS, _MOST_ROUNDS = 4, 100


def shadings_of(values: F64, tree: PixelTree, corners: Integers, tolerance: float = 0.0) -> F64:
    """Return shadings m (K, 3) the brightest of which, at every normal of a tree, is the opening of values (N,) ≥ 0.

    Parameters
    ----------
    corners : the `outermost` of the normals, which always hold shadings down
    tolerance : by how much of the brightest value a shading may pass over others before it is held down to them
    """
    scale = float(values.max(initial=0.0))
    if not scale > 0:
        return np.zeros((1, 3))
    heights = values / scale
    allowed = max(tolerance, _ROUNDING)
    held = np.union1d(corners, _lowest(heights, len(heights) // _FIRST + 1))
    open_ = np.arange(len(heights))
    part = tree
    for round_ in range(_MOST_ROUNDS):
        shadings, tight = shadings_under(tree.normals[held], heights[held])
        excess = support(shadings, part) - heights[open_]
        above = excess > allowed
        if not above.any():
            return shadings * scale
        # What is not passed over by few constraints is not by more: it can hold nothing down.
        open_, excess, part = open_[above], excess[above], part.part(above)
        # Ever more at a time, lest what curves everywhere take a round for every few of its pixels.
        worst = open_[_lowest(-excess, len(excess) // (_PARTS << max(round_ - _PATIENT_ROUNDS, 0)) + 1)]
        held = np.union1d(held[tight], worst)
    raise RuntimeError("the opening found no end")  # a round adds what is violated; all pixels are in long before


def _lowest(values: F64, run: int) -> Integers:
    """Return where in each run of so many values the lowest is."""
    starts = np.arange(0, len(values), run)
    padded = np.append(values, np.full(-len(values) % run, np.inf)).reshape(-1, run)
    lowest: Integers = starts + padded.argmin(axis=1)
    return lowest
