"""The base colour of a MatCap's component by its white patch (the MatCap paper, section 3.2)."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import LUMINANCE

Colour = tuple[float, float, float]

# What is as bright as the brightest within one step of 8 bits counts as the patch, lest one noisy pixel decides.
_AS_BRIGHT = 1 - 1 / 256
_LEAST_SHARE = 1 / 256


def white_patch(picture: NDArray[np.floating], mask: NDArray[np.bool_]) -> Colour:
    """Return the base colour α₀: the colour where luminance is greatest, for there the light is taken to be white.

    A channel that is dark there, but not in the whole picture, cannot be divided by; each is at least 1/256 of the
    greatest. A black picture is taken for white, so that dividing and multiplying leave it as it is.

    Parameters
    ----------
    picture : (H, W, 3) linear light
    mask : (H, W) bool, the pixels that count

    Returns
    -------
    base_colour : three finite numbers above 0
    """
    colours = np.asarray(picture[mask], np.float64)
    luminance = colours @ LUMINANCE
    if not luminance.size or not luminance.max() > 0:
        return 1.0, 1.0, 1.0
    patch = colours[luminance >= _AS_BRIGHT * luminance.max()].mean(axis=0)
    red, green, blue = (float(channel) for channel in np.maximum(patch, _LEAST_SHARE * patch.max()))
    return red, green, blue
