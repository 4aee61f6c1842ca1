"""Meshes whose grain breaks along seams: vertices are split where tangents must not be averaged (AMC paper, section 7).

A garment is laid out in texture space as its pieces were cut from the cloth. Where two pieces are sewn together the
surface goes on smoothly and the grain does not: that edge in the light is what an AMC is made to show (its figure 11).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.corners import CornerMesh, check_corners
from processing.mesh.edges import edge_neighbours, joined
from processing.mesh.model import Mesh
from processing.mesh.normals import smooth_normals
from processing.mesh.rows import sums_by, unique_rows
from processing.mesh.tangents import area_gradients, unit_in_plane_or_lost

Bools = NDArray[np.bool_]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

SEAM_DEG = 5.0
"""By so much may the grain turn where the texture coordinates jump, and still be one: an error of the mesh, no seam."""
CREASE_DEG = 60.0
"""By so much may it turn from triangle to triangle where they go on: the coarseness of a mesh, no mirrored piece."""
_LOST = 0.1
"""Gradients that sum up to a smaller share of their lengths contradict one another, as round a pole."""


@dataclass(frozen=True)
class Corners:
    """Triangles whose corners have a place, texture coordinates and a normal, each from a table of different rows.

    Attributes
    ----------
    positions, uvs, normals : (P, 3), (Q, 2) and (N, 3), object frame; normals unit
    places, layouts, uprights : (T, 3), the row of each corner in them
    laid : (T,), triangles whose texture coordinates tell how the grain runs; None is all
    """

    positions: F64
    uvs: F64
    normals: F64
    places: I64
    layouts: I64
    uprights: I64
    laid: Bools | None = None


def split_at_seams(raw: CornerMesh, *, seam_deg: float = SEAM_DEG, crease_deg: float = CREASE_DEG) -> Mesh:
    """Average ∇U at the vertices, but only where the grain goes on, as `split` does.

    Returns
    -------
    mesh : with as few vertices as that allows; its size is left as it is

    Raises
    ------
    InputError
        Indices point nowhere, no triangle has an area, a normal has no length, or u does not vary around a vertex.
    """
    check_corners(raw)
    positions, places = unique_rows(raw.positions)
    uvs, layouts = unique_rows(raw.uvs)
    corners, uv_corners = places[raw.position_corners], layouts[raw.uv_corners]
    whole = np.all(corners != np.roll(corners, 1, axis=1), axis=1)
    corners, uv_corners = corners[whole], uv_corners[whole]
    if not len(corners):
        raise InputError("mesh: has no triangle with an area; export it again")
    normals, uprights = _normals(raw, positions, corners, whole)
    mesh, lost = split(
        Corners(positions, uvs, normals, corners, uv_corners, uprights.reshape(-1, 3)),
        seam_deg=seam_deg,
        crease_deg=crease_deg,
    )
    if np.any(lost):
        raise InputError(
            f"mesh: u does not vary around {np.count_nonzero(lost)} of {len(lost)} vertices, so that they have no "
            "tangent; lay out its texture coordinates again"
        )
    return mesh


def split(raw: Corners, *, seam_deg: float = SEAM_DEG, crease_deg: float = CREASE_DEG) -> tuple[Mesh, Bools]:
    """Average ∇U at the vertices, but only where the grain goes on.

    Round each place, a triangle's grain is joined to its neighbour's if both run alike: within `crease_deg` where the
    texture coordinates go on across their common edge, within `seam_deg` where they jump, and never between a piece
    and a mirrored one. What is joined is averaged; what is not gets vertices of its own, as do different coordinates
    and different normals.

    Returns
    -------
    mesh : with as few vertices as that allows
    lost : (V,), vertices around which u does not vary, or is not laid: their tangents are 0
    """
    grain = _Grain(raw)
    groups = grain.groups(seam_deg, crease_deg)
    sums = sums_by(groups, grain.flat, int(groups.max()) + 1)
    rows = np.stack([raw.places.reshape(-1), raw.layouts.reshape(-1), raw.uprights.reshape(-1), groups], axis=1)
    vertices, triangles = unique_rows(rows)
    place, layout, upright, group = vertices.astype(np.int64).T
    tangents, lost = unit_in_plane_or_lost(sums[group], raw.normals[upright])
    mesh = Mesh(
        positions=raw.positions[place].astype(np.float32),
        normals=raw.normals[upright].astype(np.float32),
        tangents=tangents,
        uvs=raw.uvs[layout].astype(np.float32),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
    )
    return mesh, lost


class _Grain:
    """The direction of ∇U at every corner (3T of them, triangle by triangle), in the plane of its normal."""

    def __init__(self, raw: Corners) -> None:
        self._places = raw.places
        self._layouts = raw.layouts.reshape(-1)
        uprights = raw.normals[raw.uprights.reshape(-1)]
        gradients = area_gradients(raw.positions, raw.uvs[raw.layouts, 0], raw.places)
        if raw.laid is not None:
            gradients[~raw.laid] = 0
        gradients = np.repeat(gradients, 3, axis=0)
        self.flat: F64 = gradients - uprights * np.sum(gradients * uprights, axis=1, keepdims=True)
        self._length = np.linalg.norm(self.flat, axis=1)
        self._direction = self.flat / np.maximum(self._length, 1e-30)[:, None]
        first, second = (raw.uvs[raw.layouts[:, end]] - raw.uvs[raw.layouts[:, 0]] for end in (1, 2))
        self._side = np.repeat(np.sign(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]), 3)
        self._unlaid = None if raw.laid is None else np.repeat(~raw.laid, 3)

    def groups(self, seam_deg: float, crease_deg: float) -> I64:
        """Give every corner (3T,) the number of its group; the corners of a group share a tangent."""
        one, other, goes_on = self._neighbours()
        cosine = np.sum(self._direction[one] * self._direction[other], axis=1)
        alike = cosine >= np.where(goes_on, _cosine(crease_deg), _cosine(seam_deg))
        # A triangle without a gradient of its own goes with its neighbour in the same piece.
        alike |= goes_on & ((self._length[one] == 0) | (self._length[other] == 0))
        alike &= self._side[one] * self._side[other] >= 0
        if self._unlaid is not None:
            alike &= ~(self._unlaid[one] | self._unlaid[other])
        count = len(self.flat)
        groups = joined(one[alike], other[alike], count)
        # Round a pole each triangle leads on to the next until none agrees with all: there each keeps its own.
        lost = self._contradicts(groups)
        groups = np.where(lost[groups], groups.max() + 1 + np.arange(count), groups)
        if self._unlaid is not None:
            groups[self._unlaid] = groups.max() + 1
        return groups

    def _contradicts(self, groups: I64) -> Bools:
        count = int(groups.max()) + 1
        sums, lengths = sums_by(groups, self.flat, count), np.bincount(groups, self._length, count)
        contradicts: Bools = np.linalg.norm(sums, axis=1) < _LOST * lengths
        return contradicts

    def _neighbours(self) -> tuple[I64, I64, Bools]:
        """Pair corners at one place whose triangles share an edge; tell if texture coordinates go on across it."""
        one_low, other_low, one_high, other_high = edge_neighbours(self._places)
        layouts = self._layouts
        goes_on = (layouts[one_low] == layouts[other_low]) & (layouts[one_high] == layouts[other_high])
        one, other = np.concatenate([one_low, one_high]), np.concatenate([other_low, other_high])
        return one, other, np.concatenate([goes_on, goes_on])


def _normals(raw: CornerMesh, positions: F64, corners: I64, whole: Bools) -> tuple[F64, I64]:
    """Return the different unit normals, and for every corner (3T,) of a whole triangle the number of its own."""
    if raw.normals is not None:
        # Rounded, for the same normal comes out of two formulas with other last digits.
        normals, numbers = unique_rows(np.round(np.asarray(raw.normals, np.float64), 9))
        chosen = numbers[raw.position_corners[whole]].reshape(-1)
    else:
        normals, chosen = smooth_normals(positions, corners), corners.reshape(-1)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    lost = int(np.count_nonzero(length[np.unique(chosen)] <= 1e-12 * length.max()))
    if lost:
        raise InputError(f"mesh: {lost} of its normals have no length; take out folded triangles, or export it again")
    return normals / np.where(length > 0, length, 1), chosen


def _cosine(angle_deg: float) -> float:
    return math.cos(math.radians(angle_deg))
