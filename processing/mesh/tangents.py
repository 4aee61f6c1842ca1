"""Tangents of a mesh from its texture coordinates (the AMC paper, section 6)."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.rows import sums_by

F32 = NDArray[np.float32]
Floats = NDArray[np.floating]
_FLAT = 1e-12


def vertex_tangents(positions: F32, normals: F32, uvs: F32, triangles: NDArray[np.int32]) -> F32:
    """Find ∇U in every triangle and average it at the vertices, weighted by area.

    ∇U is the vector in the triangle's plane along which u grows fastest. With edges e1, e2 from one corner, the
    differences of u along them, and N = e1 × e2, it is (du1·e2 − du2·e1) × N / |N|².

    Parameters
    ----------
    positions, normals : (V, 3), the object's own frame; normals unit
    uvs : (V, 2)
    triangles : (T, 3)

    Returns
    -------
    tangents : (V, 3) float32, unit, orthogonal to the normals

    Raises
    ------
    InputError
        u does not vary around some vertex, so that it has no tangent.
    """
    weighted = area_gradients(positions, uvs[triangles, 0], triangles)
    summed = sums_by(triangles.reshape(-1).astype(np.int64), np.repeat(weighted, 3, axis=0), len(positions))
    return unit_in_plane(summed, np.asarray(normals, np.float64))


def area_gradients(positions: Floats, values: Floats, triangles: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return each triangle's gradient of what is given at its corners, (T, 3), times twice its area.

    Parameters
    ----------
    values : (T, 3), at the corners of each triangle
    """
    corners = np.asarray(positions, np.float64)[triangles]
    u = np.asarray(values, np.float64)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    du_first, du_second = u[:, 1] - u[:, 0], u[:, 2] - u[:, 0]
    across = np.cross(first, second)
    twice_area = np.linalg.norm(across, axis=1, keepdims=True)
    # |N| times the gradient: the weight by area comes for free, and a triangle without area has no say.
    weighted: NDArray[np.float64] = np.cross(du_first[:, None] * second - du_second[:, None] * first, across)
    weighted /= np.maximum(twice_area, _FLAT)
    return weighted


def unit_in_plane(vectors: NDArray[np.float64], normals: NDArray[np.float64]) -> F32:
    """Bring gradients (V, 3) into the planes of unit normals (V, 3) and to length one.

    Raises
    ------
    InputError
        A gradient vanishes in its plane.
    """
    unit, lost = unit_in_plane_or_lost(vectors, normals)
    if np.any(lost):
        raise InputError(
            f"mesh: u does not vary around {np.count_nonzero(lost)} of {len(lost)} vertices, so that they have no "
            "tangent; lay out its texture coordinates again"
        )
    return unit


def unit_in_plane_or_lost(vectors: NDArray[np.float64], normals: NDArray[np.float64]) -> tuple[F32, NDArray[np.bool_]]:
    """Do what `unit_in_plane` does, and tell which vectors (V,) vanish in their planes instead; those become 0."""
    flat = vectors - normals * np.sum(vectors * normals, axis=1, keepdims=True)
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    lost = length[:, 0] <= _FLAT
    unit: F32 = np.where(lost[:, None], 0, flat / np.where(lost[:, None], 1, length)).astype(np.float32)
    return unit, lost
