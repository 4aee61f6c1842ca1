"""Where a mesh keeps a distant light from itself, ray by ray, in double precision."""

import numpy as np
from numpy.typing import NDArray

from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.surface import Surface, in_view

F64 = NDArray[np.float64]
_CLEAR = 1e-4
"""How far another surface must be, in radii of the unit sphere, to stand in the way; nearer is the surface itself."""


def reaches(surface: Surface, mesh: Mesh, camera: Camera, towards: F64) -> NDArray[np.bool_]:
    """Tell at which visible points (N,) a light arrives from the unit direction `towards`, view frame.

    It does not where the surface faces away, or a triangle of the mesh stands in the way.
    """
    basis = _basis(towards)
    hidden = hidden_points(surface.points @ basis.T, in_view(mesh.positions, camera) @ basis.T, mesh.triangles)
    reached: NDArray[np.bool_] = (surface.normals @ towards > 0) & ~hidden
    return reached


def hidden_points(points: F64, vertices: F64, triangles: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Tell which points (N, 3) have a triangle above them, z growing towards the light.

    Triangle by triangle, with the points sorted by x, so that each looks at few.
    """
    order = np.argsort(points[:, 0])
    sorted_points = points[order]
    corners = vertices[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    first = np.searchsorted(sorted_points[:, 0], low[:, 0])
    last = np.searchsorted(sorted_points[:, 0], high[:, 0], side="right")
    hidden = np.zeros(len(points), bool)
    for number in np.flatnonzero(first < last):
        some = slice(first[number], last[number])
        near = sorted_points[some]
        chosen = np.flatnonzero(
            (near[:, 1] >= low[number, 1]) & (near[:, 1] <= high[number, 1]) & (near[:, 2] < high[number, 2])
        )
        if len(chosen):
            height = _height_over(near[chosen, :2], corners[number])
            hidden[first[number] + chosen[height > near[chosen, 2] + _CLEAR]] = True
    unsorted = np.zeros_like(hidden)
    unsorted[order] = hidden
    return unsorted


def _height_over(places: F64, triangle: F64) -> F64:
    """Return the z of a triangle (3, 3) over places (N, 2); −∞ beside it."""
    first, second = triangle[1] - triangle[0], triangle[2] - triangle[0]
    area = first[0] * second[1] - first[1] * second[0]
    if area == 0:
        return np.full(len(places), -np.inf)
    x, y = (places - triangle[0, :2]).T
    b = (x * second[1] - y * second[0]) / area
    c = (first[0] * y - first[1] * x) / area
    inside = (b >= 0) & (c >= 0) & (b + c <= 1)
    return np.where(inside, triangle[0, 2] + b * first[2] + c * second[2], -np.inf)


def _basis(towards: F64) -> F64:
    """Return two directions across and the one towards the light, in rows (3, 3)."""
    least = np.eye(3)[np.argmin(np.abs(towards))]
    right = np.cross(least, towards)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])
