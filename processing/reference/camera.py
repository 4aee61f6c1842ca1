"""Where the eye is and how it projects."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Camera:
    """A projection of the view frame (x right, y up, z towards the camera; its origin in the object's middle).

    Attributes
    ----------
    view_from_object : (3, 3) float64, a rotation
    clip_from_view : (4, 4) float64, to OpenGL's clip space (each axis −w..w, z growing with distance)
    eye_distance : the eye is at (0, 0, eye_distance); None if the projection is orthographic
    """

    view_from_object: F64
    clip_from_view: F64
    eye_distance: float | None

    def to_eye(self, points: F64) -> F64:
        """Return unit vectors (N, 3) from points (N, 3) to the eye, view frame."""
        if self.eye_distance is None:
            return np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
        rays = np.array([0.0, 0.0, self.eye_distance]) - points
        unit: F64 = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
        return unit
