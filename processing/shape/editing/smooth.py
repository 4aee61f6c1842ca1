"""Cross-bilateral smoothing of normals (the Shape paper, section 5)."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.shape.bands import in_bands
from processing.shape.model import BACKGROUND, ShadingBuffers

F32 = NDArray[np.float32]
_FARTHEST = 2.5
"""Where weights end, in standard deviations."""
_FARTHEST_DEPTH = 9
"""Where weights of depth end: half the square of standard deviations."""
_BINS = 256


def smoothed(buffers: ShadingBuffers, normals: F32, radius_px: float, depth_radius: float | None = None) -> F32:
    """Average (n_x, n_y) over pixels that are near in the picture and in depth, and on the same surface.

    OpenCV's joint filter looks weights up in bins over the whole range of depth, which are too coarse beside a far
    background; and it knows nothing of surfaces.

    Parameters
    ----------
    normals : (H, W, 3) unit
    radius_px : standard deviation
    depth_radius : standard deviation in depth; None is twice what the surfaces' depth changes over the radius, as the
        median has it

    Returns
    -------
    normals : (H, W, 3) unit
    """
    depth = np.ascontiguousarray(-buffers.positions[..., 2], np.float32)
    if depth_radius is None:
        inside = (buffers.surfaces[:, 1:] == buffers.surfaces[:, :-1]) & (buffers.surfaces[:, 1:] != BACKGROUND)
        steps = np.abs(np.diff(depth, axis=1))[inside]
        depth_radius = 2 * radius_px * float(np.median(steps)) if steps.size else 0.0
    reach = max(1, math.ceil(_FARTHEST * radius_px))
    along = np.arange(-reach, reach + 1)
    near = np.exp(-(along[:, None] ** 2 + along**2) / (2 * radius_px**2)).astype(np.float32)
    sums = np.zeros((*depth.shape, 2), np.float32)
    falloff = np.float32(0.5 / depth_radius**2) if depth_radius > 0 else np.float32(0)
    planes = (np.ascontiguousarray(normals, np.float32), depth, buffers.surfaces)
    far = np.exp(-np.arange(0, _FARTHEST_DEPTH + 2 / _BINS, 1 / _BINS)).astype(np.float32)
    in_bands(len(depth), lambda first, end: _average(first, end, *planes, near, far, falloff, sums))
    z = np.sqrt(np.maximum(1 - np.sum(np.square(sums), axis=-1), 0))
    # A normal that leaned over the rim goes on doing so.
    z = np.where(normals[..., 2] < 0, -z, z)
    made: F32 = np.concatenate([sums, z[..., None]], axis=-1).astype(np.float32)
    return np.where((buffers.surfaces != BACKGROUND)[..., None], made, normals)


@kernel
def _average(
    first: int,
    end: int,
    normals: F32,
    depth: F32,
    surfaces: NDArray[np.uint32],
    near: F32,
    far: F32,
    falloff: np.float32,
    sums: F32,
) -> None:
    height, width = depth.shape
    reach = near.shape[0] // 2
    for row in range(first, end):
        for column in range(width):
            surface = surfaces[row, column]
            if surface == 0:
                continue
            here = depth[row, column]
            total, x, y = np.float32(0), np.float32(0), np.float32(0)
            for r in range(max(row - reach, 0), min(row + reach + 1, height)):
                for c in range(max(column - reach, 0), min(column + reach + 1, width)):
                    apart = depth[r, c] - here
                    place = apart * apart * falloff * np.float32(_BINS)
                    if surfaces[r, c] != surface or place > np.float32(_FARTHEST_DEPTH * _BINS):
                        continue
                    weight = near[r - row + reach, c - column + reach] * far[int(place)]
                    total += weight
                    x += weight * normals[r, c, 0]
                    y += weight * normals[r, c, 1]
            sums[row, column, 0] = x / total
            sums[row, column, 1] = y / total
