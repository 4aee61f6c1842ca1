"""Unsharp masking: detail that stands out, under whatever light."""

from dataclasses import replace

import cv2
import numpy as np

from processing.ptm.model import Ptm


def sharpen(ptm: Ptm, gain: float, radius_px: float) -> Ptm:
    """Add to every coefficient what it differs by from its blurred surroundings: c + gain·(c − blur(c)).

    A blur is linear, and a picture is a sum of coefficients, so that this is the unsharp mask of the picture under any
    light. In an LRGB material the luminance is sharpened and the colour stays; in an RGB one each channel is. At the
    border the picture counts as mirrored.

    Parameters
    ----------
    gain : how much of the difference is added; 0 changes nothing
    radius_px : standard deviation of the Gaussian blur
    """
    coefficients = np.zeros_like(ptm.coefficients)
    for term, plane in enumerate(ptm.coefficients):
        blurred = cv2.GaussianBlur(plane, (0, 0), radius_px, borderType=cv2.BORDER_REFLECT)
        coefficients[term] = plane + np.float32(gain) * (plane - blurred.reshape(plane.shape))
    return replace(ptm, coefficients=coefficients)
