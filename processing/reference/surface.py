"""What is seen of a mesh at every pixel, in plain NumPy and double precision."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.mesh.model import Mesh
from processing.reference.camera import Camera
from processing.reference.raster import Fragments, rasterise

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]
_GRAZING = 1e-3


@dataclass(frozen=True)
class Surface:
    """The visible points of a mesh, view frame.

    Attributes
    ----------
    seen : pixels, triangles and weights of the N points
    points : (N, 3)
    to_eye : (N, 3) unit
    normals : (N, 3) unit, on the side that is seen
    tangents : (N, 3) unit, orthogonal to the normals
    openness : (N,) 1 where nothing occludes
    size : width and height of the picture in pixels
    """

    seen: Fragments
    points: F64
    to_eye: F64
    normals: F64
    tangents: F64
    openness: F64
    size: tuple[int, int]

    def picture(self, light: F64) -> F64:
        """Put light (N, 3) in its pixels: (H, W, 4) with coverage 0 or 1, row 0 on top."""
        picture = np.zeros((self.size[1], self.size[0], 4))
        picture[self.seen.rows, self.seen.columns, :3] = light
        picture[self.seen.rows, self.seen.columns, 3] = 1
        return picture


def visible_surface(mesh: Mesh, camera: Camera, size: tuple[int, int]) -> Surface:
    """Find the visible points of a mesh for a picture of `size`, width and height in pixels."""
    points = in_view(mesh.positions, camera)
    seen = rasterise(points, mesh.triangles, camera.clip_from_view, size)
    at_points = seen.interpolate(points, mesh.triangles)
    to_eye = camera.to_eye(at_points)
    normals = unit(seen.interpolate(in_view(mesh.normals, camera), mesh.triangles))
    normals = visible_normals(normals, to_eye, seen.front)
    tangents = tangents_in_plane(seen.interpolate(in_view(mesh.tangents, camera), mesh.triangles), normals)
    occlusion = np.ones(len(points)) if mesh.occlusion is None else mesh.occlusion.astype(np.float64)
    openness = seen.interpolate(occlusion[:, None], mesh.triangles)[:, 0]
    return Surface(seen, at_points, to_eye, normals, tangents, openness, size)


def in_view(vectors: Floats, camera: Camera) -> F64:
    """Turn what is in the object's frame (V, 3) into the view frame."""
    turned: F64 = vectors.astype(np.float64) @ camera.view_from_object.T
    return turned


def visible_normals(normals: F64, to_eye: F64, front: NDArray[np.bool_]) -> F64:
    """Turn normals to the side that is seen, (N, 3).

    A triangle and its normal must agree that it is the back which is seen; at a silhouette one of them alone is often
    wrong. What then still looks away from the eye is bent back to the silhouette.
    """
    towards = np.sum(normals * to_eye, axis=1)
    sides = np.where(~front & (towards < 0), -1.0, 1.0)
    towards = (sides * towards)[:, None]
    seen = normals * sides[:, None]
    return np.where(towards < _GRAZING, unit(seen + to_eye * (_GRAZING - towards)), seen)


def tangents_in_plane(tangents: F64, normals: F64) -> F64:
    """Bring tangents (N, 3) into the planes of unit normals, and to length one."""
    return unit(tangents - normals * np.sum(tangents * normals, axis=1, keepdims=True))


def unit(vectors: Floats) -> F64:
    """Scale vectors (N, 3) to length one."""
    scaled: F64 = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-30)
    return scaled
