"""Table coordinates found at the vertices and straight between them (the AMC paper, sections 6 and 6.2)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.raster import Fragments
from processing.reference.surface import in_view, tangents_in_plane, unit, visible_normals

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]
Coordinates = Callable[[F64, F64, F64], tuple[Floats, Floats]]


@dataclass(frozen=True)
class PerVertex:
    """Coordinates of every vertex, for its front [1] and its back [0], whichever its triangles show.

    Attributes
    ----------
    turned : (2, V, 3) table normals
    k : (2, V) in [0, 1)
    """

    turned: F64
    k: F64

    @classmethod
    def of(cls, mesh: Mesh, camera: Camera, coordinates: Coordinates) -> Self:
        """Find them; `coordinates` takes normals, tangents and directions to the eye, (V, 3) each."""
        to_eye = camera.to_eye(in_view(mesh.positions, camera))
        sides = []
        for front in (False, True):
            shown = np.full(len(mesh.positions), front)
            normals = visible_normals(unit(in_view(mesh.normals, camera)), to_eye, shown)
            sides.append(coordinates(normals, tangents_in_plane(in_view(mesh.tangents, camera), normals), to_eye))
        return cls(np.stack([turned for turned, _ in sides]), np.stack([k for _, k in sides]))


def interpolated_places(vertices: PerVertex, seen: Fragments, triangles: NDArray[np.int32]) -> F64:
    """Interpolate table normals, (N, 3); they are used as they come out, shorter than one."""
    corners = triangles[seen.triangles]
    at_corners = vertices.turned[seen.front.astype(int)[:, None], corners]
    places: F64 = np.einsum("nc,ncd->nd", seen.weights, at_corners)
    return places


def interpolated_k(vertices: PerVertex, seen: Fragments, triangles: NDArray[np.int32]) -> F64:
    """Interpolate k, or k′, which jumps half a turn away, where that varies less over the triangle; (N,)."""
    corners = triangles[seen.triangles]
    k = vertices.k[seen.front.astype(int)[:, None], corners]
    k_prime = k - np.floor(k + 0.5)
    chosen = np.where((np.ptp(k_prime, axis=1) < np.ptp(k, axis=1))[:, None], k_prime, k)
    between: F64 = np.sum(seen.weights * chosen, axis=1)
    return between
