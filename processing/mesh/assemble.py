"""From what a file holds to a mesh: checked, fitted into the unit sphere, and completed where something is missing."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from processing.mesh.files.pieces import MOST_TRIANGLES, Piece
from processing.mesh.level import cylinder_uvs, level_tangents
from processing.mesh.model import Mesh
from processing.mesh.normals import area_normals, derived_normals
from processing.mesh.rows import unique_rows
from processing.mesh.seams import Corners, split

Bools = NDArray[np.bool_]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_FARTHEST_UV = 1e9
_NO_AREA = 1e-14
"""Of a triangle, doubled, in a mesh that fills the unit sphere: no pixel ever falls into it."""


@dataclass(frozen=True)
class _Joined:
    """All pieces in one; an index of −1 says that a corner has none."""

    positions: F64
    triangles: I64
    uvs: F64
    layouts: I64
    normals: F64
    uprights: I64

    def only(self, kept: Bools) -> "_Joined":
        """Keep some of the triangles."""
        return replace(self, triangles=self.triangles[kept], layouts=self.layouts[kept], uprights=self.uprights[kept])


def assemble(pieces: Sequence[Piece], name: str) -> tuple[Mesh, tuple[str, ...]]:
    """Make a mesh: tangents as the AMC paper makes them (section 6), split where the grain breaks.

    Parameters
    ----------
    pieces : at least one; where their positions are equal they touch
    name : of the file, for messages

    Returns
    -------
    mesh : within the unit sphere, its bounding box round the origin
    remarks : what was derived or left out, a sentence each that names the file

    Raises
    ------
    InputError, FormatError
        Indices point nowhere, numbers are none, no triangle has an area, or there are too many.
    """
    remarks: list[str] = []
    raw = _fitted(_checked(_join(pieces), name), name)
    raw = _with_area(raw, name, remarks)
    positions, renamed = unique_rows(raw.positions)
    raw = replace(raw, positions=positions, triangles=renamed[raw.triangles])
    raw = _with_normals(raw, name, remarks)
    raw, laid = _with_uvs(raw, name, remarks)
    normals, upright_numbers = unique_rows(raw.normals.round(9))
    uvs, layout_numbers = unique_rows(raw.uvs)
    mesh, lost = split(
        Corners(
            positions=raw.positions,
            uvs=uvs,
            normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
            places=raw.triangles,
            layouts=layout_numbers[raw.layouts],
            uprights=upright_numbers[raw.uprights],
            laid=None if np.all(laid) else laid,
        )
    )
    return _levelled(mesh, lost, name, remarks if np.all(laid) else []), tuple(remarks)


def _join(pieces: Sequence[Piece]) -> _Joined:
    def starts(lengths: list[int]) -> list[int]:
        return [0, *np.cumsum(lengths).tolist()]

    def indices(found: I64 | None, start: int, triangles: int) -> I64:
        return np.full((triangles, 3), -1) if found is None else found + start

    def tables(found: Sequence[F64 | None], width: int) -> list[F64]:
        return [np.zeros((0, width)) if one is None else one for one in found]

    uvs, normals = tables([p.uvs for p in pieces], 2), tables([p.normals for p in pieces], 3)
    places = starts([len(p.positions) for p in pieces])
    return _Joined(
        positions=np.concatenate([p.positions for p in pieces]),
        triangles=np.concatenate([p.triangles + start for p, start in zip(pieces, places, strict=False)]),
        uvs=np.concatenate(uvs),
        layouts=np.concatenate(
            [
                indices(p.uv_triangles, start, len(p.triangles))
                for p, start in zip(pieces, starts([len(one) for one in uvs]), strict=False)
            ]
        ),
        normals=np.concatenate(normals),
        uprights=np.concatenate(
            [
                indices(p.normal_triangles, start, len(p.triangles))
                for p, start in zip(pieces, starts([len(one) for one in normals]), strict=False)
            ]
        ),
    )


def _checked(raw: _Joined, name: str) -> _Joined:
    """Refuse what makes no mesh, and leave out positions that no triangle uses."""
    if len(raw.triangles) > MOST_TRIANGLES:
        raise FormatError(f"{name}: has {len(raw.triangles):,} triangles, {MOST_TRIANGLES:,} are the most; reduce it")
    for what, indices, least, values in (
        ("positions", raw.triangles, 0, raw.positions),
        ("texture coordinates", raw.layouts, -1, raw.uvs),
        ("normals", raw.uprights, -1, raw.normals),
    ):
        if indices.size and (indices.min() < least or indices.max() >= len(values)):
            raise FormatError(
                f"{name}: a triangle names {what} that are not among its {len(values):,}; export it again"
            )
    used = np.zeros(len(raw.positions), np.bool_)
    used[raw.triangles] = True
    positions = raw.positions[used]
    broken = int(np.count_nonzero(~np.all(np.isfinite(positions), axis=1)))
    if broken:
        raise InputError(f"{name}: {broken:,} of its {len(positions):,} positions are no numbers; export it again")
    named = np.zeros(len(raw.uvs), np.bool_)
    named[raw.layouts[raw.layouts >= 0]] = True
    if not np.all(np.abs(raw.uvs[named]) <= _FARTHEST_UV):
        raise InputError(
            f"{name}: some of its texture coordinates are no numbers, or beyond ±{_FARTHEST_UV:g}; export it again"
        )
    return replace(raw, positions=positions, triangles=(np.cumsum(used) - 1)[raw.triangles])


def _fitted(raw: _Joined, name: str) -> _Joined:
    """Move the middle of the bounding box to the origin and scale to the unit sphere, whatever the unit."""
    peak = np.abs(raw.positions).max(initial=0)
    if peak > 0:
        scaled = raw.positions / peak  # squares of the largest numbers there are would be none
        centred = scaled - (scaled.min(axis=0) + scaled.max(axis=0)) / 2
        reach = np.linalg.norm(centred, axis=1).max()
        if reach > 1e-12:
            return replace(raw, positions=(centred / reach).round(9))
    raise InputError(f"{name}: has no triangle with an area; export it again")


def _with_area(raw: _Joined, name: str, remarks: list[str]) -> _Joined:
    wide = np.linalg.norm(area_normals(raw.positions, raw.triangles), axis=1) > _NO_AREA
    if not np.any(wide):
        raise InputError(f"{name}: has no triangle with an area; export it again")
    if not np.all(wide):
        remarks.append(f"{name}: {np.count_nonzero(~wide):,} of its {len(wide):,} triangles have no area; left out")
    return raw.only(wide)


def _with_normals(raw: _Joined, name: str, remarks: list[str]) -> _Joined:
    """Give every corner a unit normal, and every triangle the side of its normals."""
    longest = np.abs(raw.normals).max(axis=1, initial=0)
    usable = np.isfinite(longest) & (longest > 0)
    scaled = raw.normals[usable] / longest[usable, None]
    normals = np.zeros_like(raw.normals)
    normals[usable] = scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
    given = (raw.uprights >= 0) & np.append(usable, False)[raw.uprights]
    uprights = raw.uprights
    if not np.all(given):
        more, numbers = derived_normals(raw.positions, raw.triangles)
        uprights = np.where(given, uprights, numbers + len(normals))
        normals = np.concatenate([normals, more])
        whose = "has no normals" if not np.any(given) else f"{np.mean(~given):.1%} of its corners have no normal"
        remarks.append(f"{name}: {whose}; derived from its triangles, sharp edges kept")
    facing = np.sum(area_normals(raw.positions, raw.triangles) * normals[uprights].sum(axis=1), axis=1)
    turned = facing < 0
    if np.any(turned):
        remarks.append(
            f"{name}: {np.count_nonzero(turned):,} of its {len(turned):,} triangles run against their normals; "
            "turned over"
        )
    order = np.where(turned[:, None], [0, 2, 1], [0, 1, 2])
    used, numbers = np.unique(np.take_along_axis(uprights, order, axis=1), return_inverse=True)
    return replace(
        raw,
        triangles=np.take_along_axis(raw.triangles, order, axis=1),
        layouts=np.take_along_axis(raw.layouts, order, axis=1),
        uprights=numbers.reshape(-1, 3),
        normals=normals[used],
    )


def _with_uvs(raw: _Joined, name: str, remarks: list[str]) -> tuple[_Joined, Bools]:
    """Give every corner texture coordinates, and tell for which triangles (T,) they were the file's."""
    laid = np.all(raw.layouts >= 0, axis=1)
    u = np.append(raw.uvs[:, 0], 0)[raw.layouts[laid]]
    why = "has no texture coordinates"
    if u.size and np.all(u == u[:, :1]):
        laid, why = np.zeros_like(laid), "its texture coordinates have no extent in u"
    if np.all(laid):
        return raw, laid
    if np.any(laid):
        why = f"{np.count_nonzero(~laid):,} of its {len(laid):,} triangles have no texture coordinates"
    remarks.append(f"{name}: {why}; laid on by a cylinder about y, grain level round it")
    projected = cylinder_uvs(raw.positions, raw.triangles[~laid])
    layouts = raw.layouts.copy()
    layouts[~laid] = np.arange(len(projected)).reshape(-1, 3) + len(raw.uvs)
    return replace(raw, uvs=np.concatenate([raw.uvs, projected]), layouts=layouts), laid


def _levelled(mesh: Mesh, lost: Bools, name: str, remarks: list[str]) -> Mesh:
    if not np.any(lost):
        return mesh
    remarks.append(
        f"{name}: u does not vary around {np.count_nonzero(lost):,} of its {len(lost):,} vertices; "
        "grain laid level there"
    )
    tangents = mesh.tangents.copy()
    tangents[lost] = level_tangents(mesh.normals[lost].astype(np.float64)).astype(np.float32)
    return replace(mesh, tangents=tangents)
