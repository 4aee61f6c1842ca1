"""Grain and texture coordinates for a surface that has none: level round the upright axis, as on a lathe."""

import math

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_UPRIGHT = 1e-3
"""Sine of the angle between a normal and the y axis, below which every direction is level."""


def level_tangents(normals: F64) -> F64:
    """Return the level direction in each surface, y × n, to the right of who looks at it from outside.

    On a surface of revolution about y that is ∇U of an azimuth. Where the surface itself lies level, it is x.

    Parameters
    ----------
    normals : (V, 3), unit

    Returns
    -------
    tangents : (V, 3), unit, orthogonal to the normals
    """
    x, y, z = normals.T
    aside = np.stack([z, np.zeros_like(z), -x], axis=1)
    right = np.stack([1 - x * x, -x * y, -x * z], axis=1)
    chosen = np.where(np.hypot(x, z)[:, None] < _UPRIGHT, right, aside)
    tangents: F64 = chosen / np.linalg.norm(chosen, axis=1, keepdims=True)
    return tangents


def cylinder_uvs(positions: F64, triangles: I64) -> F64:
    """Lay texture coordinates on by a cylinder about the y axis.

    u is the azimuth in turns, 0.5 in front, and may leave 0..1 by less than one turn, so that no triangle goes the long
    way round; v goes from 0 at y = −1 to 1 at y = 1.

    Parameters
    ----------
    positions : (P, 3), within the unit sphere
    triangles : (T, 3)

    Returns
    -------
    uvs : (3T, 2), for each corner its own
    """
    x, y, z = positions.T
    azimuth = (np.arctan2(x, z) / math.tau + 0.5)[triangles]
    on_axis = (np.hypot(x, z) < 1e-9)[triangles]
    first = np.take_along_axis(azimuth, np.argmin(on_axis, axis=1)[:, None], axis=1)
    u = azimuth - np.round(azimuth - first)
    # The axis has every azimuth; the middle of the others bends nothing.
    others = np.sum(np.where(on_axis, 0, u), axis=1, keepdims=True) / np.maximum(
        np.sum(~on_axis, axis=1, keepdims=True), 1
    )
    u = np.where(on_axis, others, u)
    return np.stack([u, ((y + 1) / 2)[triangles]], axis=2).reshape(-1, 2)
