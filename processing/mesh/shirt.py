"""A shirt: body panels and sleeves, the grain along each, so that it meets at an angle where sleeves are set in.

It is the AMC paper's example (its figure 11): light breaks at the shoulder's seam, where the surface goes on.
"""

import math

import numpy as np
from numpy.typing import NDArray

from processing.mesh.corners import CornerMesh, put_together
from processing.mesh.grids import fit_unit_sphere, grid_triangles
from processing.mesh.model import Mesh
from processing.mesh.seams import split_at_seams

F64 = NDArray[np.float64]

ARMPIT = 0.625
"""Height of the armhole's lower end, 0 at the hem to 1 at the shoulder."""
ARM_DEG = 46.0
"""By so much the sleeves hang down from the horizontal."""
_TIP = 1.0
"""Height of the shoulder's outer end over the hem; all lengths are in it."""
_NECK_SHARE = 9 / 32
"""Half of the neck's opening, as a share of the panel's columns on either side of its middle."""
_SLEEVE = 0.42
_CUFF = 0.125
_UV_SCALE = 0.4
"""So that every piece fits into its quarter of the cloth."""


def _half_width(height: F64) -> F64:
    # Whoever draws another mesh would wait for this import.
    from scipy.interpolate import PchipInterpolator

    width: F64 = PchipInterpolator([0, 0.3, 0.65, 0.85, 1], [0.41, 0.385, 0.4, 0.35, 0.335])(height)
    return width


def shirt(wide: int = 64, tall: int = 96, along: int = 48) -> Mesh:
    """Return a shirt whose texture coordinates are its sewing pattern, u upwards along each piece.

    Parameters
    ----------
    wide : cells across a panel, a multiple of 64 so that the neck ends at a vertex
    tall : cells from hem to shoulder, a multiple of 8 so that the armhole does
    along : cells along a sleeve
    """
    front, back = (_panel(side, wide, tall) for side in (1, -1))
    right, left = (_sleeve(front, back, side, round(tall * ARMPIT), along) for side in (1, -1))
    # Turned over is what runs to the left, seen from outside, from column to column.
    pieces = [
        _piece(front, front[..., 1], corner=(0.0, 0.0), turned=False),
        _piece(back, back[..., 1], corner=(0.0, 0.5), turned=True),
        _piece(right, -right @ _arm(1), corner=(0.5, 0.0), turned=True),
        _piece(left, -left @ _arm(-1), corner=(0.5, 0.5), turned=False),
    ]
    return fit_unit_sphere(split_at_seams(put_together(pieces)))


def _panel(side: int, wide: int, tall: int) -> F64:
    """Return the front (side 1) or the back (side −1), (tall + 1, wide + 1, 3): rows upwards, columns from −x to x.

    A panel is half of an ellipse at each height; at the armhole it ends before it meets the other.
    """
    v, share = np.meshgrid(np.linspace(0, 1, tall + 1), np.linspace(-1, 1, wide + 1), indexing="ij")
    rise = np.clip((v - ARMPIT) / (1 - ARMPIT), 0, 1)
    last = np.arccos(0.72 * np.sin(math.pi * rise) ** 0.8 * (rise < 1))
    angle = share * last
    # Round the body all hems hang in the same folds, so that the panels meet at their sides.
    round_body = angle if side > 0 else math.pi - angle
    loose = (1 - v) ** 2
    fold = 1 + loose * (0.05 * np.cos(6 * round_body + 0.4) + 0.03 * np.cos(9 * round_body + 1.9))
    across = np.sin(angle) / np.sin(last)
    inside = np.clip(1 - (share / _NECK_SHARE) ** 2, 0, None) ** 2
    slope = 0.09 * np.clip((1 - np.abs(across)) / (1 - math.sin(_NECK_SHARE * math.pi / 2)), 0, 1)
    dip = v**6 * inside * (0.17 if side > 0 else 0.035)
    depth = 0.22 * np.sqrt(1 - np.clip((v - 0.5) / 0.5, 0, 1) ** 3)
    z = np.cos(angle) * depth + 0.1 * v**6 * inside
    return (
        np.stack([_half_width(v) * np.sin(angle) * fold, v * (_TIP + slope) - dip, side * z * fold], axis=-1).round(9)
        + 0.0
    )


def _sleeve(front: F64, back: F64, side: int, armpit: int, along: int) -> F64:
    """Return the sleeve at x > 0 (side 1) or x < 0, (along + 1, around + 1, 3).

    Its first row is the armhole, from the armpit over the front to the shoulder and down the back; its last the cuff.
    """
    column = -1 if side > 0 else 0
    hole = np.concatenate([front[armpit:, column], back[armpit:-1, column][::-1]])
    turn = np.linspace(0, math.tau, len(hole))
    outwards = _arm(side)
    upwards = np.array([-outwards[1], abs(outwards[0]), 0]) * [side, 1, 1]
    middle = (hole[0] + hole[len(hole) // 2]) / 2 + outwards * _SLEEVE
    wave = 1 + 0.06 * np.cos(5 * turn + 0.7)
    cuff = middle + _CUFF * (
        -upwards * (np.cos(turn) * wave)[:, None] + np.array([0, 0, 0.9]) * (np.sin(turn) * wave)[:, None]
    )
    # A cubic curve leaves the shoulder as it slopes, and comes down along the arm.
    way = np.linspace(0, 1, along + 1)[:, None, None]
    high = (1 - np.cos(turn))[:, None] / 2
    lean = math.radians(24) * high + math.radians(25) * (1 - high)
    start = np.concatenate([side * np.cos(lean), -np.sin(lean), 0 * lean], axis=1) * (0.4 * high + 0.18 * (1 - high))
    end = outwards * 0.4
    curve: F64 = (
        (2 * way**3 - 3 * way**2 + 1) * hole
        + (way**3 - 2 * way**2 + way) * start
        + (3 * way**2 - 2 * way**3) * cuff
        + (way**3 - way**2) * end
    )
    curve[0], curve[-1, -1] = hole, curve[-1, 0]
    curve[:, -1] = curve[:, 0]
    rounded: F64 = curve.round(9) + 0.0  # −0 and 0 are one place
    return rounded


def _arm(side: int) -> F64:
    """Return the direction of the arm at x > 0 (side 1) or x < 0, from the shoulder to the hand."""
    down = math.radians(ARM_DEG)
    return np.array([side * math.cos(down), -math.sin(down), 0], np.float64)


def _piece(places: F64, upwards: F64, *, corner: tuple[float, float], turned: bool) -> CornerMesh:
    """Lay a grid (rows, columns, 3) flat on the cloth, as high as `upwards` says and as wide as its rows are long.

    Parameters
    ----------
    corner : of the piece's quarter of the cloth
    turned : rows and columns run clockwise, seen from outside
    """
    rows, columns = places.shape[:2]
    triangles = grid_triangles(rows, columns)[:, :: -1 if turned else 1]
    steps = np.linalg.norm(np.diff(places, axis=1), axis=2)
    across = np.concatenate([np.zeros((rows, 1)), np.cumsum(steps, axis=1)], axis=1)
    across -= across[:, columns // 2, None]
    left = turned == (upwards[-1, 0] > upwards[0, 0])
    # v is to the left of u, seen from outside: cloth has a right side.
    flat = np.stack([upwards, across if left else -across], axis=-1).reshape(-1, 2)
    uvs = (flat - flat.min(axis=0)) * _UV_SCALE + np.array(corner) + 0.02
    return CornerMesh(places.reshape(-1, 3), uvs, position_corners=triangles, uv_corners=triangles)
