"""Opening by erosion and dilation over pixels (the MatCap paper, section 4.1), one channel.

erode(p) = min v_q/(n_p·n_q) is one by the reach of the points n_q/v_q along n_p, and dilate(p) = max e_q (n_p·n_q) the
reach of the points e_q n_q. That only pixels with n_p·n_q > 0 count goes without saying: p itself reaches further than
those with less.
"""

import numpy as np
from numpy.typing import NDArray

from processing.matcap.separation.pixel_tree import PixelTree
from processing.matcap.separation.support import support

F64 = NDArray[np.float64]


def erode(values: F64, tree: PixelTree) -> F64:
    """Erode values (N,) ≥ 0 at the normals of a tree: 0 wherever a black pixel lies less than a right angle away."""
    black = values == 0
    eroded = np.zeros(len(values))
    if not black.all():
        eroded = 1 / support(tree.normals[~black] / values[~black, None], tree)
    if black.any():
        eroded[support(tree.normals[black], tree) > 0] = 0
    return eroded


def dilate(values: F64, tree: PixelTree, wanted: PixelTree) -> F64:
    """Dilate values (N,) ≥ 0 at the normals of a tree to those of another.

    0 wherever no pixel but black ones lies less than a right angle away.
    """
    bright = values > 0
    if not bright.any():
        return np.zeros(len(wanted.normals))
    return np.maximum(support(tree.normals[bright] * values[bright, None], wanted), 0)
