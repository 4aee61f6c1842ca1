"""Smoothing the breaks in a map where neighbouring directions come from remote pixels (the Shape paper, section 3.2).

The paper takes the gradient of a second map, which tells which pixel a texel's light is from, and blurs by its
magnitude. How far that of one smooth patch goes depends on its curvature: where a pixel is a small part of a texel,
neighbouring texels are many pixels apart. So what counts is how much further apart they are than the polygons explain.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
_EXPLAINED = 3.0
_FULL = 0.05
"""Of the surface's extent in the picture: from this leap on the blur is whole."""
_LEAST_SIGMA = 0.2
"""Texels; a narrower Gaussian changes nothing."""


def breaks(pixels: F64, narrowness: F64, known: Mask, extent_px: float) -> F64:
    """Tell how broken a map is at each texel, 0 to 1.

    Parameters
    ----------
    pixels : (2, S, S, 2) where in the picture the light of a texel is from
    narrowness : (2, S, S) how many pixels go into a texel, the way they are narrowest
    known : (2, S, S)
    extent_px : of the surface
    """
    broken = np.zeros(known.shape)
    for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:, :, :-1], np.s_[:, :, 1:])):
        leap = np.linalg.norm(pixels[one] - pixels[other], axis=-1)
        leap -= _EXPLAINED * np.maximum(narrowness[one], narrowness[other])
        share = np.where(known[one] & known[other], np.clip(leap / (_FULL * extent_px), 0, 1), 0)
        broken[one] = np.maximum(broken[one], share)
        broken[other] = np.maximum(broken[other], share)
    return broken


def smooth(halves: F32, broken: F64, blur_deg: float) -> F32:
    """Blur a map where it is broken, by a Gaussian that widens and narrows along with how much.

    Parameters
    ----------
    halves : (2, S, S, 3)
    broken : (2, S, S), 0 to 1
    blur_deg : standard deviation where it is 1
    """
    size = halves.shape[1]
    along = (2 * np.arange(size) + 1) / size - 1
    texel_rad = 2 / size * 2 / (1 + along**2 + along[:, None] ** 2)
    widest = np.radians(blur_deg) / texel_rad
    reach = math.ceil(2 * float(np.radians(blur_deg) / texel_rad.max()))
    if not reach or not broken.any():
        return halves
    spread = [
        ndimage.gaussian_filter(ndimage.maximum_filter(half, 2 * reach + 1), reach / 2, mode="nearest")
        for half in broken
    ]
    sigma = np.stack(spread) * widest
    smoothed = halves.copy()
    _blur(np.ascontiguousarray(halves), np.where(sigma >= _LEAST_SIGMA, sigma, 0), smoothed)
    return smoothed


@kernel
def _blur(halves: F32, sigma: F64, out: F32) -> None:
    size = halves.shape[1]
    weights = np.zeros(2 * size + 1)
    for half in range(halves.shape[0]):
        for row in range(size):
            for column in range(size):
                width = sigma[half, row, column]
                if width == 0:
                    continue
                reach = min(math.ceil(3 * width), size)
                for k in range(reach + 1):
                    weights[k] = math.exp(-0.5 * (k / width) ** 2)
                red, green, blue, total = 0.0, 0.0, 0.0, 0.0
                for r in range(max(0, row - reach), min(size, row + reach + 1)):
                    for c in range(max(0, column - reach), min(size, column + reach + 1)):
                        weight = weights[abs(r - row)] * weights[abs(c - column)]
                        red += weight * halves[half, r, c, 0]
                        green += weight * halves[half, r, c, 1]
                        blue += weight * halves[half, r, c, 2]
                        total += weight
                out[half, row, column, 0] = red / total
                out[half, row, column, 1] = green / total
                out[half, row, column, 2] = blue / total
