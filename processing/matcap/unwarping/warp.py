"""A component's disc spread over all directions (the MatCap paper, section 4.2).

What is seen at an angle θ off the view axis came from θ·(1 + μ). A texel at the angle a off the axis is looked up at
a/(1 + μ); beyond (1 + μ)·90° lies the blind spot, which nothing on the disc shows.
"""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_MOST_SAMPLES = 64
_KNOTS, _FARTHEST = 8192, 1.5
"""Of tables over a texel's distance from the middle, −1 to 1 across the map: its corners lie at √2."""


def unwarped(disc: F32, slope: float, size: int) -> tuple[F32, F32]:
    """Look the texels of a dual paraboloid map up on a disc, each the mean of what it covers.

    Parameters
    ----------
    disc : (S, S, 3) filled beyond what is known
    slope : μ, 0 to 1
    size : N

    Returns
    -------
    front, back : (N, N, 3); in the blind spot 0
    """
    sides = np.zeros((2, size, size, 3), np.float32)
    if disc.any():
        for texels, behind in zip(sides, (False, True), strict=True):
            least, most = (
                (math.tan((1 - slope) * math.pi / 4), 2.0) if behind else (0.0, math.tan((1 + slope) * math.pi / 4))
            )
            _unwarp(disc, *_tables(slope, behind=behind), least, most, texels)
    return sides[0], sides[1]


def _tables(slope: float, *, behind: bool) -> tuple[F64, F64]:
    """Return the radius at which texels look on the disc, and how much they cover for their size, by their place."""
    places = np.linspace(0, _FARTHEST, _KNOTS + 1)
    turned = math.pi - 2 * np.arctan(places) if behind else 2 * np.arctan(places)
    angles = np.minimum(turned / (1 + slope), math.pi / 2)
    radii = np.sin(angles)
    along = 2 / (1 + places * places) / (1 + slope) * np.cos(angles)
    return radii, np.maximum(along, radii / np.maximum(places, 1e-9))


@kernel
def _unwarp(disc: F32, radii: F64, spreads: F64, least: float, most: float, texels: F32) -> None:
    size, side = texels.shape[0], disc.shape[0]
    knots = (len(radii) - 1) / _FARTHEST
    for row in range(size):
        for column in range(size):
            u, v = (2 * column + 1) / size - 1, 1 - (2 * row + 1) / size
            knot = math.sqrt(u * u + v * v) * knots
            first = int(knot)
            covered = (spreads[first] + (knot - first) * (spreads[first + 1] - spreads[first])) * side / size
            samples = int(min(max(math.ceil(covered), 1.0), _MOST_SAMPLES))
            red, green, blue, count = 0.0, 0.0, 0.0, 0
            for i in range(samples):
                for j in range(samples):
                    su = u + (2 * (i + 0.5) / samples - 1) / size
                    sv = v + (2 * (j + 0.5) / samples - 1) / size
                    place = max(math.sqrt(su * su + sv * sv), 1e-9)
                    if place < least or place > most:
                        continue
                    knot = place * knots
                    first = int(knot)
                    outwards = (radii[first] + (knot - first) * (radii[first + 1] - radii[first])) / place
                    x = min(max((1 + outwards * su) * side / 2 - 0.5, 0.0), side - 1.0)
                    y = min(max((1 - outwards * sv) * side / 2 - 0.5, 0.0), side - 1.0)
                    left, top = int(x), int(y)
                    right, bottom = min(left + 1, side - 1), min(top + 1, side - 1)
                    x, y = x - left, y - top
                    a, b, c, d = (1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y
                    red += a * disc[top, left, 0] + b * disc[top, right, 0]
                    red += c * disc[bottom, left, 0] + d * disc[bottom, right, 0]
                    green += a * disc[top, left, 1] + b * disc[top, right, 1]
                    green += c * disc[bottom, left, 1] + d * disc[bottom, right, 1]
                    blue += a * disc[top, left, 2] + b * disc[top, right, 2]
                    blue += c * disc[bottom, left, 2] + d * disc[bottom, right, 2]
                    count += 1
            if count:
                texels[row, column, 0] = red / count
                texels[row, column, 1] = green / count
                texels[row, column, 2] = blue / count
