"""Dual paraboloid maps: two square pictures that hold a colour for every direction.

A texel stands at (u, v) in −1..1, u to the right, v up, row 0 at v = +1. With q = u² + v² the front map's texel is the
direction (2u, 2v, 1 − q)/(1 + q), the back map's (2u, 2v, q − 1)/(1 + q). A half-sphere each lies within the unit
circle. The corners beyond it go on across the seam: they hold what the other map has there, so that texels can be
interpolated anywhere in the circle.
"""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]


def texel_directions(size: int) -> tuple[F64, F64]:
    """Return the unit directions (S, S, 3) of the front and the back map's texel centres."""
    along = (2 * np.arange(size) + 1) / size - 1
    u, v = np.meshgrid(along, -along)
    q = u * u + v * v
    front = np.stack([2 * u, 2 * v, 1 - q], axis=-1) / (1 + q)[..., None]
    return front, front * np.array([1.0, 1.0, -1.0])


def places(directions: Floats) -> tuple[NDArray[np.bool_], F64, F64]:
    """Find unit directions (..., 3) in the maps.

    Returns
    -------
    in_front, columns, rows : (...) whether in the front map, and texture coordinates, 0 to 1 over the map's side
    """
    d = np.asarray(directions, np.float64)
    in_front = d[..., 2] >= 0
    u, v = (d[..., axis] / (1 + np.abs(d[..., 2])) for axis in (0, 1))
    return in_front, (1 + u) / 2, (1 - v) / 2
