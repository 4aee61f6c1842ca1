"""Pixels that a renderer's noise has made far too bright: one of them would lift a whole environment above it."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
_SIDE = 5
_RANK = 3
"""Up to two neighbours may be as hot."""


def hot_pixels(shading: F32, shown: Mask, factor: float) -> Mask:
    """Find pixels brighter than a multiple of all around them but two, in any channel.

    Parameters
    ----------
    shading : (H, W, C), finite where shown
    shown : (H, W) the pixels of one surface; others are not compared with
    factor : at least 1

    Returns
    -------
    hot : (H, W)
    """
    rows, columns = np.flatnonzero(shown.any(axis=1)), np.flatnonzero(shown.any(axis=0))
    hot = np.zeros(shown.shape, bool)
    if not rows.size:
        return hot
    window = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    around = np.ones((_SIDE, _SIDE), bool)
    around[_SIDE // 2, _SIDE // 2] = False
    for channel in range(shading.shape[2]):
        plane = np.where(shown[window], shading[window][..., channel], -np.inf)
        rank = int(around.sum()) - _RANK
        beside = ndimage.rank_filter(plane, rank, footprint=around, mode="constant", cval=-np.inf)
        hot[window] |= shown[window] & np.isfinite(beside) & (beside > 0) & (plane > factor * beside)
    return hot
