"""Light over all directions, as a formula, and maps of it."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal
from processing.matcap.model import Component, DecomposedMatcap
from processing.paraboloid.maps import texel_directions

F64 = NDArray[np.float64]

_SKY = (((0.2, 0.7, 0.68), (1.0, 0.9, 0.7), 2.0), ((-0.9, 0.1, -0.42), (0.3, 0.5, 1.0), 3.0))
_LAMPS = (
    ((-0.5, 0.6, 0.62), (1.0, 0.95, 0.9), 90.0),
    ((0.75, 0.3, -0.59), (0.9, 0.4, 0.2), 40.0),
    ((0.1, -0.99, 0.05), (0.2, 0.9, 0.5), 60.0),
)


def soft(directions: F64) -> F64:
    """Broad lobes."""
    return _lobes(directions, _SKY) * 0.5 + 0.05


def sharp(directions: F64) -> F64:
    """Narrow ones, one of them across the seam between front and back."""
    return _lobes(directions, _LAMPS)


def analytic(
    size: int = 96, table_normal: TableNormal = TableNormal.RECTIFIED, slopes: tuple[float, float] = (0.3, 0.9)
) -> DecomposedMatcap:
    front, back = texel_directions(size)
    low, high = (
        Component(light(front).astype(np.float32), light(back).astype(np.float32), colour, slope, variance)
        for light, colour, slope, variance in (
            (soft, (0.8, 0.5, 0.4), slopes[0], 0.3),
            (sharp, (0.6, 0.6, 0.7), slopes[1], 0.02),
        )
    )
    return DecomposedMatcap(low, high, table_normal, "analytic")


def _lobes(
    directions: F64, lobes: tuple[tuple[tuple[float, float, float], tuple[float, float, float], float], ...]
) -> F64:
    total = np.zeros(directions.shape)
    for towards, colour, sharpness in lobes:
        cosine = directions @ (np.array(towards) / np.linalg.norm(towards))
        total += np.exp(sharpness * (cosine - 1))[..., None] * np.array(colour)
    return total
