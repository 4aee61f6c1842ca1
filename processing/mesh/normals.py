"""Normals of a mesh that has none."""

import math

import numpy as np
from numpy.typing import NDArray

from processing.mesh.edges import edge_neighbours, joined
from processing.mesh.rows import sums_by

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

HARD_DEG = 50.0
"""Edges at which triangles lean from each other by more stay hard. A tube of eight sides is round, a box is not."""


def area_normals(positions: F64, corners: I64) -> F64:
    """Return the normals of triangles (T, 3), as long as twice their areas."""
    at = positions[corners]
    across: F64 = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    return across


def smooth_normals(positions: F64, corners: I64) -> F64:
    """Sum up the normals of the triangles round each place, weighted by area, (P, 3)."""
    across = np.repeat(area_normals(positions, corners), 3, axis=0)
    return sums_by(corners.reshape(-1), across, len(positions))


def derived_normals(positions: F64, corners: I64, hard_deg: float = HARD_DEG) -> tuple[F64, I64]:
    """Average the normals of triangles round each place, but not over hard edges.

    Parameters
    ----------
    positions : (P, 3), one row a place
    corners : (T, 3), triangles with an area

    Returns
    -------
    normals, numbers : (N, 3) unit, and which one each corner has, (T, 3)
    """
    across = area_normals(positions, corners)
    facing = across / np.linalg.norm(across, axis=1, keepdims=True)
    one_low, other_low, one_high, other_high = edge_neighbours(corners)
    soft = np.sum(facing[one_low // 3] * facing[other_low // 3], axis=1) >= math.cos(math.radians(hard_deg))
    one, other = np.concatenate([one_low[soft], one_high[soft]]), np.concatenate([other_low[soft], other_high[soft]])
    groups = joined(one, other, corners.size)
    sums = sums_by(groups, np.repeat(across, 3, axis=0), int(groups.max()) + 1)
    length = np.linalg.norm(sums, axis=1)
    # Round a twist the sum may vanish: then any of its triangles will do.
    some = np.zeros_like(sums)
    some[groups] = np.repeat(facing, 3, axis=0)
    lost = length < 1e-9 * np.bincount(groups, np.repeat(np.linalg.norm(across, axis=1), 3))
    normals = np.where(lost[:, None], some, sums / np.where(lost, 1, length)[:, None])
    return normals, groups.reshape(-1, 3)
