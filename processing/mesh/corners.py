"""A mesh as modelling programs write it, before its vertices are made."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

Floats = NDArray[np.floating]
Integers = NDArray[np.integer]


@dataclass(frozen=True)
class CornerMesh:
    """Triangles with indices of their own for places and for texture coordinates, as in OBJ files.

    Attributes
    ----------
    positions : (P, 3), object frame; equal ones are one place
    uvs : (Q, 2), u along the grain
    position_corners : (T, 3) indices of positions, counter-clockwise seen from outside
    uv_corners : (T, 3) indices of uvs
    normals : (P, 3), kept as they are; None averages those of the triangles, so that the surface is smooth everywhere
    """

    positions: Floats
    uvs: Floats
    position_corners: Integers
    uv_corners: Integers
    normals: Floats | None = None


def put_together(pieces: Sequence[CornerMesh]) -> CornerMesh:
    """Put pieces beside one another; where their positions are equal they touch. Normals only if all have some."""
    place_starts = np.cumsum([0, *(len(piece.positions) for piece in pieces[:-1])])
    uv_starts = np.cumsum([0, *(len(piece.uvs) for piece in pieces[:-1])])
    normals = [piece.normals for piece in pieces if piece.normals is not None]
    return CornerMesh(
        positions=np.concatenate([piece.positions for piece in pieces]),
        uvs=np.concatenate([piece.uvs for piece in pieces]),
        position_corners=np.concatenate(
            [piece.position_corners + start for piece, start in zip(pieces, place_starts, strict=True)]
        ),
        uv_corners=np.concatenate([piece.uv_corners + start for piece, start in zip(pieces, uv_starts, strict=True)]),
        normals=np.concatenate(normals) if len(normals) == len(pieces) else None,
    )


def check_corners(raw: CornerMesh) -> None:
    """Refuse indices that point nowhere, and numbers that are none.

    Raises
    ------
    InputError
    """
    for name, indices, values in (
        ("positions", raw.position_corners, raw.positions),
        ("texture coordinates", raw.uv_corners, raw.uvs),
    ):
        if indices.size and not (indices.min() >= 0 and indices.max() < len(values)):
            raise InputError(f"mesh: a triangle names {name} that are not among its {len(values)}; export it again")
        if not np.all(np.isfinite(values)):
            raise InputError(f"mesh: {name} hold what is no number; export it again")
