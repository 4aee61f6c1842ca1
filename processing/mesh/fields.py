"""Other fields of tangents on the same surface: turned, or as somebody painted them (the AMC paper, figure 10)."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.model import Mesh

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

FAINTEST = 0.05
"""Of a painted vector. Where codes of 8 bits give less, their rounding turns it by more than 6°."""


def turned(mesh: Mesh, angle_deg: float) -> Mesh:
    """Turn every tangent in the surface, counter-clockwise seen from outside: 90° swaps warp and weft.

    Raises
    ------
    InputError
        The angle is no number.
    """
    if not math.isfinite(angle_deg):
        raise InputError(f"mesh: tangents cannot be turned by {angle_deg:g} deg; give a number of degrees")
    turn_rad = math.radians(math.remainder(angle_deg, 360))
    along, across = _frame(mesh)
    return replace(mesh, tangents=_unit(along * math.cos(turn_rad) + across * math.sin(turn_rad)))


def painted(mesh: Mesh, directions: F32, name: str = "direction map") -> Mesh:
    """Take the tangents from a picture of directions, laid on the surface by its texture coordinates.

    The picture's x goes along the mesh's own tangents (∇U), its y at right angles to them, to the side to which v
    grows. It repeats beyond 0..1, and is read between its texels as vectors: angles would go the long way round
    between 359° and 1°.

    Parameters
    ----------
    directions : (H, W, 2) float32, x to the right and y upwards, of any length; row 0 on top, texel centres
    name : of the picture, for errors

    Raises
    ------
    InputError
        The directions are no such array, or vanish at some vertex.
    """
    if directions.ndim != 3 or directions.shape[2] != 2 or 0 in directions.shape:
        raise InputError(f"{name}: an array {directions.shape} holds no directions; give (H, W, 2)")
    wanted = _read_repeating(directions, mesh.uvs.astype(np.float64))
    # Written so that no number at all counts as faint.
    faint = int(np.count_nonzero(~(np.linalg.norm(wanted, axis=1) >= FAINTEST)))
    if faint:
        raise InputError(
            f"{name}: names no direction at {faint} of {len(wanted)} vertices; paint where it is grey, "
            "and leave no soft edge between opposite directions"
        )
    along, across = _frame(mesh)
    across *= _v_side(mesh)[:, None]
    return replace(mesh, tangents=_unit(along * wanted[:, :1] + across * wanted[:, 1:]))


def _frame(mesh: Mesh) -> tuple[F64, F64]:
    """Return the tangents (V, 3), and what is 90° counter-clockwise of them seen from outside."""
    along = mesh.tangents.astype(np.float64)
    return along, np.cross(mesh.normals.astype(np.float64), along)


def _v_side(mesh: Mesh) -> F64:
    """Tell for every vertex if v grows to the left of u, seen from outside: 1, or −1 on a mirrored piece."""
    corners = mesh.uvs.astype(np.float64)[mesh.triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    doubled_areas = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    sums = np.zeros(len(mesh.positions))
    for corner in range(3):
        np.add.at(sums, mesh.triangles[:, corner], doubled_areas)
    return np.where(sums < 0, -1.0, 1.0)


def _read_repeating(directions: F32, uvs: F64) -> F64:
    """Read a picture (H, W, C) bilinearly at texture coordinates (V, 2)."""
    height, width = directions.shape[:2]
    column, row = uvs[:, 0] * width - 0.5, (1 - uvs[:, 1]) * height - 0.5
    left, top = np.floor(column).astype(np.int64), np.floor(row).astype(np.int64)
    right_share, lower_share = (column - left)[:, None], (row - top)[:, None]

    def texels(down: int, aside: int) -> F64:
        read: F64 = directions[(top + down) % height, (left + aside) % width].astype(np.float64)
        return read

    upper = texels(0, 0) * (1 - right_share) + texels(0, 1) * right_share
    lower = texels(1, 0) * (1 - right_share) + texels(1, 1) * right_share
    between: F64 = upper * (1 - lower_share) + lower * lower_share
    return between


def _unit(vectors: F64) -> F32:
    unit: F32 = (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)
    return unit
