"""The disc about −z that nothing on a MatCap shows, filled from its rim (the MatCap paper, section 4.2, figure 9).

The maps are conformal, so Poisson's equation on the sphere is that of the plane. In the back map the spot is a disc
of radius R = tan((1 − μ)·45°), where each harmonic has its solution in closed form. The guide is radial, of length
D(φ)·r/R with D the derivative at the rim: what changes towards the spot goes on, ever slower, to its centre. Without a
guide the fill is harmonic.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bools = NDArray[np.bool_]

_RINGS, _SPOKES = 129, 1024
_BAND_RAD = math.radians(8)


def spot_radius(slope: float) -> float:
    """Return how much of the back map, −1 to 1, the spot's radius takes."""
    return math.tan((1 - slope) * math.pi / 4)


def rim_place(slope: float, side: int) -> float:
    """Return how far from the back map's centre the middle of a disc's outermost pixels lies; they bound the fill."""
    return math.tan((math.pi - _rim_angle(side) * (1 + slope)) / 2)


def back_places(size: int, *, behind: bool) -> tuple[F64, F64]:
    """Return where (u, v) in the back map the texels of a map (N, N) lie."""
    along = (2 * np.arange(size) + 1) / size - 1
    u, v = np.meshgrid(along, -along)
    if behind:
        return u, v
    q = np.maximum(u * u + v * v, 1e-12)
    return u / q, v / q


def filled_from_rim(disc: F32, slope: float, *, guided: bool) -> F32:
    """Solve for the spot on rings and spokes.

    Parameters
    ----------
    disc : (S, S, 3) filled beyond what is known

    Returns
    -------
    spot : (rings, spokes, 3) ≥ 0 and no brighter than the disc; from the centre to `rim_place`, and from u to v
    """
    outer = _rim_angle(disc.shape[0])
    inner = max(outer - _BAND_RAD, outer / 2)
    rim, within = _ring(disc, math.sin(outer)), _ring(disc, math.sin(inner))
    radius, beyond = (math.tan((math.pi - angle * (1 + slope)) / 2) for angle in (outer, inner))
    slopes = (rim - within) / (radius - beyond) * radius if guided else np.zeros_like(rim)
    orders = np.arange(_SPOKES // 2 + 1)[:, None]
    edge, guide = np.fft.rfft(rim, axis=0), np.fft.rfft(slopes, axis=0)
    r = np.linspace(0, 1, _RINGS)[:, None, None]
    # r² + …: what the guide's divergence 2D/R asks for, less what it is at the rim. At order 2 it is r² ln r.
    two = orders == 2
    falling = r ** orders.astype(float)
    bent = np.where(
        two, r**2 * np.log(np.maximum(r, 1e-300)) / 2, (r**2 - falling) * 2 / np.where(two, 1, 4 - orders**2)
    )
    spot = np.fft.irfft(edge * falling + guide * bent, n=_SPOKES, axis=1)
    return np.clip(spot, 0, float(disc.max(initial=0))).astype(np.float32)


def lay_spot(texels: F32, spot: F32, reach: float, *, behind: bool) -> None:
    """Lay a spot of rings and spokes over those texels (N, N, 3) of a map that lie in it, as far as it reaches."""
    chosen, u, v = _within(reach, texels.shape[0], behind=behind)
    rings = np.hypot(u, v) / reach * (_RINGS - 1)
    spokes = np.arctan2(v, u) / (2 * math.pi) * _SPOKES % _SPOKES
    wrapped = np.concatenate([spot, spot[:, :1]], axis=1)
    for channel in range(3):
        texels[chosen, channel] = map_coordinates(wrapped[..., channel], [rings, spokes], order=1, mode="nearest")


def lay_painted(texels: F32, painted: F32, slope: float, *, behind: bool) -> None:
    """Lay a back map (P, P, 3) that was painted elsewhere over those texels of a map that lie in the spot."""
    chosen, u, v = _within(spot_radius(slope), texels.shape[0], behind=behind)
    side = painted.shape[0]
    down, across = (1 - v) / 2 * side - 0.5, (1 + u) / 2 * side - 0.5
    for channel in range(3):
        texels[chosen, channel] = map_coordinates(painted[..., channel], [down, across], order=1, mode="nearest")


def _within(reach: float, size: int, *, behind: bool) -> tuple[Bools, F64, F64]:
    u, v = back_places(size, behind=behind)
    chosen = np.hypot(u, v) < reach
    return chosen, u[chosen], v[chosen]


def _rim_angle(side: int) -> float:
    return math.asin(1 - 1 / side)


def _ring(disc: F32, radius: float) -> F64:
    size = disc.shape[0]
    angles = 2 * math.pi * np.arange(_SPOKES) / _SPOKES
    down = (1 - radius * np.sin(angles)) / 2 * size - 0.5
    across = (1 + radius * np.cos(angles)) / 2 * size - 0.5
    return np.stack(
        [map_coordinates(disc[..., channel], [down, across], order=1, output=np.float64) for channel in range(3)],
        axis=1,
    )
