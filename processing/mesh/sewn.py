"""A garment: pieces cut from straight cloth and sewn together, so that the grain meets at an angle in every seam."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.mesh import jets, surfaces
from processing.mesh.corners import CornerMesh, put_together
from processing.mesh.grids import fit_unit_sphere, grid, grid_triangles, unit
from processing.mesh.model import Mesh
from processing.mesh.seams import split_at_seams

F64 = NDArray[np.float64]

PANELS = 6
"""Round the skirt; even, so that neighbours differ."""
YOKE = 0.72
"""Height of the yoke's lower edge, 0 at the hem to 1 at the waist."""
_FRONT = 0.04
"""Share of a turn by which the first seam stands off the middle of the front, to the left of who looks at it."""


@dataclass(frozen=True)
class Piece:
    """A part of the skirt that is cut in one.

    Attributes
    ----------
    panel : counted from the front, counter-clockwise from above
    low, high : its edges, 0 at the hem to 1 at the waist
    grain_deg : from the piece's own middle line upwards to its grain, counter-clockwise seen from outside
    """

    panel: int
    low: float
    high: float
    grain_deg: float


def pattern() -> list[Piece]:
    """Return the pieces: panels cut on the bias, to the left and to the right in turn, below a yoke cut across."""
    panels = [Piece(number, 0.0, YOKE, 45.0 if number % 2 == 0 else -45.0) for number in range(PANELS)]
    return panels + [Piece(number, YOKE, 1.0, 90.0) for number in range(PANELS)]


def skirt(wide: int = 48, tall: int = 120) -> Mesh:
    """Return a flared skirt; its texture coordinates are its sewing pattern.

    Unrolled, a cone of which the slant makes the angle φ with the axis spans 2π sin φ, so that the middle lines of
    neighbours lie 2π sin φ / 6 = 30° apart. The grain thus jumps by 60° from panel to panel, counted as grain is, from
    0° to 90°, by 45° between panels and yoke, and by 30° in the yoke.

    Parameters
    ----------
    wide : cells across a piece
    tall : cells from hem to waist
    """
    pieces = [_cut(piece, wide, max(1, round(tall * (piece.high - piece.low)))) for piece in pattern()]
    return fit_unit_sphere(split_at_seams(put_together(pieces)))


def _cut(piece: Piece, wide: int, tall: int) -> CornerMesh:
    """Return one piece, its edges not sewn yet."""
    across, up = grid(wide, tall)
    height = piece.low + up * (piece.high - piece.low)
    point = surfaces.skirt(*jets.parameters((piece.panel + across) / PANELS - _FRONT, height))
    # Rounded, the two sides of a seam have the same bits.
    positions = np.stack([part.value for part in point], axis=-1).round(9)
    along_u, along_v = (np.stack([getattr(part, name) for part in point], axis=-1) for name in ("du", "dv"))
    corners = grid_triangles(tall + 1, wide + 1)
    return CornerMesh(
        positions=positions.reshape(-1, 3),
        uvs=_laid_out(piece, across, height),
        position_corners=corners,
        uv_corners=corners,
        normals=unit(np.cross(along_u, along_v)).reshape(-1, 3),
    )


def _laid_out(piece: Piece, across: F64, height: F64) -> F64:
    """Unroll the cone round the piece's middle line, and lay the piece on the cloth with u along the grain, (V, 2)."""
    slant = surfaces.SKIRT_WAIST + (1 - height) * (1 - surfaces.SKIRT_WAIST)
    turn = (across - 0.5) * (2 * math.pi * surfaces.SKIRT_FLARE / PANELS)
    aside, upwards = slant * np.sin(turn), (1 + surfaces.SKIRT_WAIST) / 2 - slant * np.cos(turn)
    grain = math.radians(piece.grain_deg)
    u = upwards * math.cos(grain) - aside * math.sin(grain)
    v = -upwards * math.sin(grain) - aside * math.cos(grain)
    return np.stack([u, v], axis=-1).reshape(-1, 2) + 0.5
