"""A triangle mesh in memory."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Mesh:
    """What a renderer needs of a surface, in the object's own frame (right-handed, y up).

    Attributes
    ----------
    positions : (V, 3) float32, within the unit sphere
    normals : (V, 3) float32, unit, on the side from which the triangles run counter-clockwise
    tangents : (V, 3) float32, unit, along the surface's ∇U and orthogonal to the normal
    uvs : (V, 2) float32, u along the grain, v upwards in a picture that is laid on the surface
    triangles : (T, 3) int32, indices of vertices
    occlusion : (V,) float32, how much of the surroundings each vertex sees over its surface, weighted by the cosine:
        1 = open, 0 = closed; None where nobody asked
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    tangents: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.int32]
    occlusion: NDArray[np.float32] | None = None
