"""A ball that mirrors light that is a formula, in perspective or from far away."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from processing.shape.reflection.environment import mirror
from tests.processing.matcap.maps import sharp

F32 = NDArray[np.float32]


class Seen(NamedTuple):
    """In the order of `reconstruct_reflection`."""

    reflection: F32
    normals: F32
    to_eye: F32
    positions: F32
    occlusion: F32
    used: NDArray[np.bool_]


def ball(size: int = 90, distance: float = 4.0, bumps: float = 0.0) -> Seen:
    """See a ball that nearly fills the picture, its middle on the view axis."""
    focal_px = 1.2 * size
    along = (np.arange(size) + 0.5 - size / 2) / focal_px
    x, y = np.meshgrid(along, -along)
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    middle, radius = np.array([0.0, 0.0, -distance]), 0.38 * distance
    nearest = rays @ middle
    inside = nearest**2 - distance**2 + radius**2
    used = inside > 0
    positions = np.where(used[..., None], rays * (nearest - np.sqrt(np.maximum(inside, 0)))[..., None], 0)
    normals = np.where(used[..., None], (positions - middle) / radius, 0)
    if bumps:
        rows, columns = np.indices(used.shape)
        normals += bumps * np.stack([np.sin(columns / 6), np.cos(rows / 7), 0 * x], axis=-1) * used[..., None]
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
    n, v, p = (values.astype(np.float32) for values in (normals, -rays, positions))
    light = np.where(used[..., None], sharp(mirror(n, v).astype(np.float64)), 0).astype(np.float32)
    return Seen(light, n, v, p, np.ones(used.shape, np.float32), used)
