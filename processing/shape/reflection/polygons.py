"""Smooth patches of a surface, cut into the polygons that its pixels span (the Shape paper, section 3.2, figure 3).

Two neighbours belong to one smooth patch if neither their normals nor their depths jump. Four pixels that hang together
are a quad, three at a patch's border a triangle.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
Indices = NDArray[np.int32]
_STEEPEST = 0.02
"""Cosine between normal and view at which a surface counts as seen from the side."""


@dataclass(frozen=True)
class Smoothness:
    """Where a patch ends.

    Attributes
    ----------
    normal_jump_deg : angle between the normals of two neighbours
    depth_jump : step along the view, in multiples of what the surface's slant explains
    """

    normal_jump_deg: float = 30.0
    depth_jump: float = 3.0

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        if not (0 < self.normal_jump_deg <= 180 and self.depth_jump > 0):
            raise InputError(
                f"reflection environment: patches that end at {self.normal_jump_deg:g} deg and {self.depth_jump:g} "
                "times the slant mean nothing; give 0 to 180 deg, and a positive multiple"
            )


def joined(used: Mask, normals: F32, to_eye: F32, positions: F32 | None, smoothness: Smoothness) -> tuple[Mask, Mask]:
    """Tell which neighbouring pixels belong to one smooth patch.

    Parameters
    ----------
    used : (H, W) the pixels of one surface that count
    normals, to_eye : (H, W, 3) unit
    positions : (H, W, 3), or None where they are not known

    Returns
    -------
    across, down : (H, W − 1) and (H − 1, W), a pixel and the one on its right, and below
    """
    least = float(np.cos(np.radians(smoothness.normal_jump_deg)))
    somewhere, jump = (normals, np.inf) if positions is None else (positions, smoothness.depth_jump)
    pairs = []
    for down, right, one, other in ((0, 1, np.s_[:, :-1], np.s_[:, 1:]), (1, 0, np.s_[:-1], np.s_[1:])):
        smooth = used[one] & used[other]
        _keep_smooth(normals, to_eye, somewhere, down, right, least, jump, smooth)
        pairs.append(smooth)
    return pairs[0], pairs[1]


@kernel
def _keep_smooth(
    normals: F32, to_eye: F32, positions: F32, down: int, right: int, least: float, jump: float, smooth: Mask
) -> None:
    """Take away pairs whose normals or depths jump; the latter by more than `jump` times what the slant explains."""
    for row in range(smooth.shape[0]):
        for column in range(smooth.shape[1]):
            if not smooth[row, column]:
                continue
            r, c = row + down, column + right
            alike, facing, facing_after, along, squares = 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(3):
                chord = positions[r, c, k] - positions[row, column, k]
                alike += normals[row, column, k] * normals[r, c, k]
                facing += normals[row, column, k] * to_eye[row, column, k]
                facing_after += normals[r, c, k] * to_eye[r, c, k]
                along += chord * to_eye[row, column, k]
                squares += chord * chord
            steepest = max(min(facing, facing_after), _STEEPEST)
            aside = math.sqrt(max(squares - along * along, 0.0))
            smooth[row, column] = alike >= least and (jump == np.inf or abs(along) <= jump * aside / steepest)


def polygons(across: Mask, down: Mask) -> Indices:
    """Cut patches into polygons.

    Returns
    -------
    corners : (P, 4) pixels, counted row by row, in order around; the fourth of a triangle is −1
    """
    height, width = down.shape[0] + 1, down.shape[1]
    top, right, bottom, left = across[:-1], down[:, 1:], across[1:], down[:, :-1]
    sides = top.astype(np.int8) + right + bottom + left
    start = np.arange(height * width, dtype=np.int32).reshape(height, width)
    a, b, c, d = start[:-1, :-1], start[:-1, 1:], start[1:, 1:], start[1:, :-1]
    # Three sides join all four corners; what jumps a little over the fourth is smooth on the way round.
    found = [np.stack([corner[sides >= 3] for corner in (a, b, c, d)], axis=-1)]
    bends = ((top, right, (a, b, c)), (right, bottom, (b, c, d)), (bottom, left, (c, d, a)), (left, top, (d, a, b)))
    for first, second, corners in bends:
        here = (sides == 2) & first & second
        three = [corner[here] for corner in corners]
        found.append(np.stack([*three, np.full(three[0].shape, -1, np.int32)], axis=-1))
    corners_of: Indices = np.concatenate(found)
    return corners_of
