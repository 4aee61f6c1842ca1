"""Maps corrected until the disc, drawn from them, is the picture that they came from.

A picture sampled into texels, and these into pixels again, has been blurred twice. So texels are moved, as little as it
takes, until every pixel is met: by Kaczmarz's projections, a pixel at a time, and never below black.
"""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.matcap.unwarping.warp import map_densities

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bools = NDArray[np.bool_]

_SWEEPS = 80
_MET = 2e-5
"""Of a value of 1: less than a tenth of the darkest step of 8-bit sRGB."""
_DENSE = 0.9
_PATIENCE, _STALLED = 10, 0.9


def fit(front: F32, back: F32, disc: F32, known: Bools, slope: float) -> F32:
    """Correct a dual paraboloid map (N, N, 3) in place.

    Where the map is coarser than the disc it stays as it is.

    Parameters
    ----------
    disc : (S, S, 3) what is to be seen where it is known (S, S)

    Returns
    -------
    drawn : (S, S, 3) the disc drawn from the map; 0 where it is not known
    """
    size, side = front.shape[0], disc.shape[0]
    rows, columns = np.nonzero(known)
    x, y = (2 * columns + 1) / side - 1, 1 - (2 * rows + 1) / side
    radii = np.maximum(np.hypot(x, y), 1e-9)
    dense = map_densities(np.minimum(radii, 1 - 1e-9), slope) * size / side >= _DENSE
    turned = np.arcsin(radii) * (1 + slope)
    behind = turned > math.pi / 2
    places = np.tan(np.where(behind, math.pi - turned, turned) / 2) / radii
    across = np.clip((1 + places * x) / 2 * size - 0.5, 0, size - 1)
    down = np.clip((1 - places * y) / 2 * size - 0.5, 0, size - 1)
    maps = np.stack([front, back])
    wanted = np.ascontiguousarray(disc[rows, columns])
    _project(maps, wanted[dense], behind[dense], across[dense], down[dense], _SWEEPS, _MET)
    front[:], back[:] = maps
    found = np.zeros_like(wanted)
    _draw(maps, behind, across, down, found)
    drawn = np.zeros_like(disc)
    drawn[rows, columns] = found
    return drawn


@kernel
def _project(maps: F32, wanted: F32, behind: Bools, across: F64, down: F64, sweeps: int, met: float) -> None:
    last = maps.shape[1] - 1
    before = np.inf
    for sweep in range(sweeps):
        worst = 0.0
        for i in range(len(wanted)):
            half = 1 if behind[i] else 0
            left, top = int(across[i]), int(down[i])
            right, bottom = min(left + 1, last), min(top + 1, last)
            x, y = across[i] - left, down[i] - top
            a, b, c, d = (1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y
            weight = 1 / (a * a + b * b + c * c + d * d)
            for k in range(3):
                seen = a * maps[half, top, left, k] + b * maps[half, top, right, k]
                seen += c * maps[half, bottom, left, k] + d * maps[half, bottom, right, k]
                off = wanted[i, k] - seen
                worst = max(worst, abs(off))
                step = off * weight
                maps[half, top, left, k] = max(maps[half, top, left, k] + a * step, 0.0)
                maps[half, top, right, k] = max(maps[half, top, right, k] + b * step, 0.0)
                maps[half, bottom, left, k] = max(maps[half, bottom, left, k] + c * step, 0.0)
                maps[half, bottom, right, k] = max(maps[half, bottom, right, k] + d * step, 0.0)
        if worst <= met:
            return
        if sweep % _PATIENCE == 0:
            if worst > _STALLED * before:
                return
            before = worst


@kernel
def _draw(maps: F32, behind: Bools, across: F64, down: F64, drawn: F32) -> None:
    last = maps.shape[1] - 1
    for i in range(len(drawn)):
        half = 1 if behind[i] else 0
        left, top = int(across[i]), int(down[i])
        right, bottom = min(left + 1, last), min(top + 1, last)
        x, y = across[i] - left, down[i] - top
        for k in range(3):
            above = (1 - x) * maps[half, top, left, k] + x * maps[half, top, right, k]
            below = (1 - x) * maps[half, bottom, left, k] + x * maps[half, bottom, right, k]
            drawn[i, k] = (1 - y) * above + y * below
