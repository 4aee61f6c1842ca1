"""A component's disc spread over all directions (the MatCap paper, section 4.2).

What is seen at an angle θ off the view axis came from θ·(1 + μ). A texel at the angle a off the axis is looked up at
a/(1 + μ); beyond (1 + μ)·90° lies the blind spot, which nothing on the disc shows.
"""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]

_MOST_SAMPLES = 64


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
    front, back = np.zeros((size, size, 3), np.float32), np.zeros((size, size, 3), np.float32)
    if disc.any():
        _unwarp(disc, slope, False, front)
        _unwarp(disc, slope, True, back)
    return front, back


@kernel
def _unwarp(disc: F32, slope: float, behind: bool, texels: F32) -> None:
    size, side = texels.shape[0], disc.shape[0]
    for row in range(size):
        for column in range(size):
            u, v = (2 * column + 1) / size - 1, 1 - (2 * row + 1) / size
            place = max(math.sqrt(u * u + v * v), 1e-9)
            turned = math.pi - 2 * math.atan(place) if behind else 2 * math.atan(place)
            angle = min(turned / (1 + slope), math.pi / 2)
            along = 2 / (1 + place * place) / (1 + slope) * math.cos(angle)
            covered = max(along, math.sin(angle) / place) * side / size
            samples = int(min(max(math.ceil(covered), 1.0), _MOST_SAMPLES))
            red, green, blue, count = 0.0, 0.0, 0.0, 0
            for i in range(samples):
                for j in range(samples):
                    su = u + (2 * (i + 0.5) / samples - 1) / size
                    sv = v + (2 * (j + 0.5) / samples - 1) / size
                    place = max(math.sqrt(su * su + sv * sv), 1e-9)
                    turned = math.pi - 2 * math.atan(place) if behind else 2 * math.atan(place)
                    angle = turned / (1 + slope)
                    if angle > math.pi / 2:
                        continue
                    radius = math.sin(angle)
                    x = min(max((1 + radius * su / place) * side / 2 - 0.5, 0.0), side - 1.0)
                    y = min(max((1 - radius * sv / place) * side / 2 - 0.5, 0.0), side - 1.0)
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
