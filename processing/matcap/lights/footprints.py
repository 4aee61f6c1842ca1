"""The light that a painted light sends in each direction, blurred by a material (the MatCap paper, section 5.1).

On a Gaussian or a straight edge a Gaussian blur has a closed form; variances add. Distances are angles along great
circles, so that a footprint has the same size wherever it stands.
"""

from typing import assert_never

import numpy as np
from numpy.typing import NDArray
from scipy.special import chndtr, erf

from processing.matcap.lights.model import Direction, Disc, Edge, Light, Line, Spot

F64 = NDArray[np.float64]
_SHARPEST = 1e-8
"""A variance, in radians squared, that stands for none."""
_NEAR = 6.0
_BENT = 40.0
"""A disc whose radius is more standard deviations than this has an edge as good as straight."""


def footprint(light: Light, directions: F64, variance: float) -> F64:
    """Return how bright a light of colour 1 is in unit directions (..., 3) when a material blurs it: (...) float64.

    Parameters
    ----------
    variance : of the material's filter, radians squared
    """
    blur = max(variance, _SHARPEST)
    match light:
        case Spot():
            own = np.radians(light.size_deg) ** 2
            d = _angles(directions, light.direction)
            return np.asarray(own / (own + variance) * np.exp(-0.5 * d * d / (own + variance)))
        case Disc():
            return _disc(_angles(directions, light.direction), np.radians(light.size_deg), np.sqrt(blur))
        case Line():
            return _line(light, directions, variance, blur)
        case Edge():
            height = np.arcsin(np.clip(directions @ unit(light.pole), -1, 1))
            return np.asarray(0.5 + 0.5 * erf(height / np.sqrt(2 * blur)))
        case _:
            assert_never(light)


def unit(direction: Direction) -> F64:
    vector = np.asarray(direction, np.float64)
    return np.asarray(vector / np.linalg.norm(vector))


def _disc(d: F64, radius: float, sigma: float) -> F64:
    """Blur a disc: the share of a Gaussian about each place that lies in it, which is a noncentral χ² of 2."""
    straight = 0.5 + 0.5 * erf((radius - d) / (np.sqrt(2) * sigma))
    if radius > _BENT * sigma:
        return np.asarray(straight)
    result = np.where(d < radius, 1.0, 0.0)
    near = np.abs(d - radius) < _NEAR * sigma
    result[near] = chndtr((radius / sigma) ** 2, 2, (d[near] / sigma) ** 2)
    return result


def _line(light: Line, directions: F64, variance: float, blur: float) -> F64:
    start, end = unit(light.start), unit(light.end)
    side = unit(tuple(np.cross(start, end)))
    length = np.arccos(np.clip(start @ end, -1, 1))
    own = np.radians(light.size_deg) ** 2
    across = np.arcsin(np.clip(directions @ side, -1, 1))
    # Counted from the middle, so that the other end of the great circle is the farthest.
    middle = unit(tuple(start + end))
    along = np.arctan2(directions @ np.cross(side, middle), directions @ middle)
    sharp = np.sqrt(2 * blur)
    lit = 0.5 * (erf((along + length / 2) / sharp) - erf((along - length / 2) / sharp))
    return np.asarray(np.sqrt(own / (own + variance)) * np.exp(-0.5 * across**2 / (own + variance)) * lit)


def _angles(directions: F64, towards: Direction) -> F64:
    """Return angles in radians; from the chord, which is exact for small ones too."""
    chord = np.linalg.norm(directions - unit(towards), axis=-1)
    return np.asarray(2 * np.arcsin(np.clip(chord / 2, 0, 1)))
