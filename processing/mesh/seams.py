"""Meshes whose grain breaks along seams: vertices are split where tangents must not be averaged (AMC paper, section 7).

A garment is laid out in texture space as its pieces were cut from the cloth. Where two pieces are sewn together the
surface goes on smoothly and the grain does not: that edge in the light is what an AMC is made to show (its figure 11).
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from litrig.base.errors import InputError
from processing.mesh.corners import CornerMesh, check_corners
from processing.mesh.model import Mesh
from processing.mesh.tangents import area_gradients, unit_in_plane

Floats = NDArray[np.floating]
Bools = NDArray[np.bool_]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

SEAM_DEG = 5.0
"""By so much may the grain turn where the texture coordinates jump, and still be one: an error of the mesh, no seam."""
CREASE_DEG = 60.0
"""By so much may it turn from triangle to triangle where they go on: the coarseness of a mesh, no mirrored piece."""
_LOST = 0.1
"""Gradients that sum up to a smaller share of their lengths contradict one another, as round a pole."""


def split_at_seams(raw: CornerMesh, *, seam_deg: float = SEAM_DEG, crease_deg: float = CREASE_DEG) -> Mesh:
    """Average ∇U at the vertices, but only where the grain goes on.

    Round each place, a triangle's grain is joined to its neighbour's if both run alike: within `crease_deg` where the
    texture coordinates go on across their common edge, within `seam_deg` where they jump, and never between a piece
    and a mirrored one. What is joined is averaged; what is not gets vertices of its own, as do different coordinates
    and different normals.

    Returns
    -------
    mesh : with as few vertices as that allows; its size is left as it is

    Raises
    ------
    InputError
        Indices point nowhere, no triangle has an area, a normal has no length, or u does not vary around a vertex.
    """
    check_corners(raw)
    positions, places = _unique_rows(raw.positions)
    uvs, layouts = _unique_rows(raw.uvs)
    corners, uv_corners = places[raw.position_corners], layouts[raw.uv_corners]
    whole = np.all(corners != np.roll(corners, 1, axis=1), axis=1)
    corners, uv_corners = corners[whole], uv_corners[whole]
    if not len(corners):
        raise InputError("mesh: has no triangle with an area; export it again")
    uprights, upright_corners = _normals(raw, positions, corners, whole)
    grain = _Grain(positions, uvs, uprights[upright_corners], corners, uv_corners)
    groups = grain.groups(seam_deg, crease_deg)
    sums = np.zeros((int(groups.max()) + 1, 3))
    np.add.at(sums, groups, grain.flat)
    rows = np.stack([corners.reshape(-1), uv_corners.reshape(-1), upright_corners, groups], axis=1)
    vertices, triangles = np.unique(rows, axis=0, return_inverse=True)
    place, layout, upright, group = vertices.T
    return Mesh(
        positions=positions[place].astype(np.float32),
        normals=uprights[upright].astype(np.float32),
        tangents=unit_in_plane(sums[group], uprights[upright]),
        uvs=uvs[layout].astype(np.float32),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
    )


class _Grain:
    """The direction of ∇U at every corner (3T of them, triangle by triangle), in the plane of its normal."""

    def __init__(self, positions: F64, uvs: F64, uprights: F64, corners: I64, uv_corners: I64) -> None:
        self._corners = corners
        self._uv_corners = uv_corners
        gradients = np.repeat(area_gradients(positions, uvs[uv_corners, 0], corners), 3, axis=0)
        self.flat: F64 = gradients - uprights * np.sum(gradients * uprights, axis=1, keepdims=True)
        self._length = np.linalg.norm(self.flat, axis=1)
        self._direction = self.flat / np.maximum(self._length, 1e-30)[:, None]
        first, second = (uvs[uv_corners[:, end]] - uvs[uv_corners[:, 0]] for end in (1, 2))
        self._side = np.repeat(np.sign(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]), 3)

    def groups(self, seam_deg: float, crease_deg: float) -> I64:
        """Give every corner (3T,) the number of its group; the corners of a group share a tangent."""
        one, other, goes_on = self._neighbours()
        cosine = np.sum(self._direction[one] * self._direction[other], axis=1)
        alike = cosine >= np.where(goes_on, _cosine(crease_deg), _cosine(seam_deg))
        # A triangle without a gradient of its own goes with its neighbour in the same piece.
        alike |= goes_on & ((self._length[one] == 0) | (self._length[other] == 0))
        joined = alike & (self._side[one] * self._side[other] >= 0)
        count = len(self.flat)
        links = coo_array((np.ones(joined.sum()), (one[joined], other[joined])), shape=(count, count))
        groups: I64 = connected_components(links, directed=False)[1].astype(np.int64)
        # Round a pole each triangle leads on to the next until none agrees with all: there each keeps its own.
        lost = self._contradicts(groups)
        return np.where(lost[groups], groups.max() + 1 + np.arange(count), groups)

    def _contradicts(self, groups: I64) -> Bools:
        sums, lengths = np.zeros((int(groups.max()) + 1, 3)), np.zeros(int(groups.max()) + 1)
        np.add.at(sums, groups, self.flat)
        np.add.at(lengths, groups, self._length)
        contradicts: Bools = np.linalg.norm(sums, axis=1) < _LOST * lengths
        return contradicts

    def _neighbours(self) -> tuple[I64, I64, Bools]:
        """Pair corners at one place whose triangles share an edge; tell if texture coordinates go on across it."""
        count = len(self._corners)
        start = np.arange(3 * count)
        end = start.reshape(-1, 3)[:, [1, 2, 0]].reshape(-1)
        place, layout = self._corners.reshape(-1), self._uv_corners.reshape(-1)
        # Every edge from its lower place to its higher one, so that both of its triangles name its ends alike.
        swapped = place[start] > place[end]
        low, high = np.where(swapped, end, start), np.where(swapped, start, end)
        order = np.lexsort((place[high], place[low]))
        low, high = low[order], high[order]
        same = np.flatnonzero((place[low[1:]] == place[low[:-1]]) & (place[high[1:]] == place[high[:-1]]))
        goes_on = (layout[low[same]] == layout[low[same + 1]]) & (layout[high[same]] == layout[high[same + 1]])
        one, other = np.concatenate([low[same], high[same]]), np.concatenate([low[same + 1], high[same + 1]])
        return one, other, np.concatenate([goes_on, goes_on])


def _unique_rows(values: Floats) -> tuple[F64, I64]:
    """Return the different rows, and for each old row the number of its new one."""
    # Adding 0 makes −0 and 0 the same bits.
    unique, numbers = np.unique(np.asarray(values, np.float64) + 0.0, axis=0, return_inverse=True)
    return unique, numbers.reshape(-1).astype(np.int64)


def _normals(raw: CornerMesh, positions: F64, corners: I64, whole: Bools) -> tuple[F64, I64]:
    """Return the different unit normals, and for every corner (3T,) of a whole triangle the number of its own."""
    if raw.normals is not None:
        # Rounded, for the same normal comes out of two formulas with other last digits.
        normals, numbers = _unique_rows(np.round(np.asarray(raw.normals, np.float64), 9))
        chosen = numbers[raw.position_corners[whole]].reshape(-1)
    else:
        normals, chosen = _smooth_normals(positions, corners), corners.reshape(-1)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    lost = int(np.count_nonzero(length[np.unique(chosen)] <= 1e-12 * length.max()))
    if lost:
        raise InputError(f"mesh: {lost} of its normals have no length; take out folded triangles, or export it again")
    return normals / np.where(length > 0, length, 1), chosen


def _smooth_normals(positions: F64, corners: I64) -> F64:
    """Sum up the normals of the triangles round each place, weighted by area."""
    at = positions[corners]
    across = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    sums = np.zeros_like(positions)
    for corner in range(3):
        np.add.at(sums, corners[:, corner], across)
    return sums


def _cosine(angle_deg: float) -> float:
    return math.cos(math.radians(angle_deg))
