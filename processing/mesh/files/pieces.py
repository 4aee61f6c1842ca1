"""What a mesh file holds, before it is checked and made into a mesh."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MOST_BYTES = 600_000_000
"""Of a mesh file."""
MOST_LINES = 15_000_000
"""Of a mesh file that is text: what readers make of a line takes far more than the line."""
MOST_TRIANGLES = 5_000_000
"""Of a mesh, every copy in a scene counted."""


@dataclass(frozen=True)
class Piece:
    """Triangles as a file has them: nothing is checked yet but the shapes of the arrays.

    Attributes
    ----------
    positions : (P, 3), the file's own frame and unit
    triangles : (T, 3) indices of positions
    uvs, uv_triangles : (Q, 2), v upwards, and (T, 3) indices of them; None where the file has none
    normals, normal_triangles : (N, 3) of any length, and (T, 3) indices of them; None where the file has none
    """

    positions: F64
    triangles: I64
    uvs: F64 | None = None
    uv_triangles: I64 | None = None
    normals: F64 | None = None
    normal_triangles: I64 | None = None
