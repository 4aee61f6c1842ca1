"""Positions that are moved, and normals that are derived from them."""

import numpy as np
from numpy.typing import NDArray

from processing.shape.editing.tilt import unit
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]


def displaced(buffers: ShadingBuffers, normals: F32, positions: F32, height: F32) -> tuple[F32, F32]:
    """Move positions along the surface's normals by a small height, and turn normals as the surface turns.

    The change of the normals that follow from positions is added to the normals that are there, which may be smoother
    than the facets seen in pixels; without a height nothing changes. What would be hidden or cast shadows then is not
    seen to.

    Parameters
    ----------
    normals, positions : (H, W, 3)
    height : (H, W), in the unit of positions

    Returns
    -------
    normals, positions : (H, W, 3) float32
    """
    moved = (positions + height[..., None] * buffers.normals).astype(np.float32)
    before, after = (facet_normals(where, buffers.surfaces) for where in (positions, moved))
    made = unit(normals + (after - before))
    return np.where((height != 0)[..., None] | np.any(after != before, axis=-1)[..., None], made, normals), moved


def facet_normals(positions: F32, surfaces: NDArray[np.uint32]) -> F32:
    """Derive normals (H, W, 3) from positions by differences within surfaces; 0 where a pixel has no neighbour."""
    p = positions.astype(np.float64)
    across = _differences(p, surfaces, 1)
    down = _differences(p, surfaces, 0)
    return unit(np.cross(across, -down).astype(np.float32))


def _differences(p: NDArray[np.float64], surfaces: NDArray[np.uint32], axis: int) -> NDArray[np.float64]:
    """Differences along an axis: central, or one-sided beside another surface."""
    step = np.diff(p, axis=axis)
    lower, upper = (slice(None, -1), slice(1, None))
    before, after = (lower, upper) if axis == 0 else ((slice(None), lower), (slice(None), upper))
    same = (surfaces[before] == surfaces[after]) & (surfaces[after] != BACKGROUND)
    step = np.where(same[..., None], step, 0)
    total, count = np.zeros_like(p), np.zeros(surfaces.shape)
    total[before] += step
    count[before] += same
    total[after] += step
    count[after] += same
    return total / np.maximum(count, 1)[..., None]
