"""The sphere's silhouette in the pictures of a turn."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Report, silent
from processing.outline.limb import weigh_apart
from processing.outline.rim_fit import Limb
from processing.outline.silhouette import load_turn
from processing.stack import Stack

F64 = NDArray[np.float64]

_MOST_FRAMES = 12
# What is no sphere was seen to reach 0.94 and 1.5 with pictures that contradict each other by a sixth of the radius;
# spheres half in the dark or before clutter have 0.6 and 0.6 with pictures that agree to two tenths of a pixel.
_LEAST_AGREEMENT, _LEAST_EVIDENCE = 0.55, 0.4
_MOST_SCATTER_SHARE, _MOST_SCATTER_PX = 0.02, 1.0
# A rim as plain as this is a rim, however the sphere wobbles.
_PLAIN_EVIDENCE, _MOST_WOBBLE_SHARE = 1.5, 0.06
# What moves round further than this is a print on the table, not a sphere mounted askew.
_MOST_OFFSET_SHARE = 0.12
_NEXT_STEP = "give --circle X Y R"
SMALLEST_RADIUS_PX = 4.0
# Between a sphere that stays and one that moves round.
_STILL_PX, _STILL_DEVIATIONS = 0.25, 3.0


@dataclass(frozen=True)
class Circle:
    """A circle in the picture; the picture's upper left corner is (0, 0), its first pixel's centre (0.5, 0.5)."""

    x_px: float
    y_px: float
    radius_px: float

    def inside(self, shape: tuple[int, int], source: str) -> "Circle":
        """Return the circle if pictures of this shape (H, W) hold all of it; `source` names them in the error."""
        height, width = shape
        reach = self.radius_px
        if not np.isfinite([self.x_px, self.y_px, reach]).all():
            raise InputError(f"{source}: a circle at {self} is no circle; {_NEXT_STEP} as numbers")
        if not reach >= SMALLEST_RADIUS_PX:
            raise InputError(
                f"{source}: a circle of radius {reach:g} px shows no material; {_NEXT_STEP} with R of "
                f"{SMALLEST_RADIUS_PX:g} or more"
            )
        if not (reach <= self.x_px + 0.5 <= width - reach + 1 and reach <= self.y_px + 0.5 <= height - reach + 1):
            raise InputError(
                f"{source}: the sphere ({self}) is cut by the border of the {width} × {height} pictures; "
                f"aim the camera so that all of it is seen, or {_NEXT_STEP} if the circle is wrong"
            )
        return self

    def __str__(self) -> str:
        return f"centre {self.x_px:.6g}, {self.y_px:.6g}, radius {self.radius_px:.6g} px"


def find_circle(stack: Stack, report: Report = silent) -> Circle:
    """Find the silhouette of the sphere that turns in these pictures: the mean one, should it move round.

    Parameters
    ----------
    stack : pictures in the order of their turntable angles; a dozen of them, spread over the turn, are looked at

    Raises
    ------
    InputError
        No circle stands out.
    """
    turn, _, factor = load_turn(stack, _MOST_FRAMES, report)
    limb, weigh = turn.find()
    centres, deviation, radius_px = turn.watch(limb)
    scatter = float(np.sqrt(np.mean((centres - centres.mean(axis=0)) ** 2)))
    if scatter > max(_STILL_PX, _STILL_DEVIATIONS * float(np.median(deviation))):
        limb = turn.sharpen(
            Limb(float(centres[:, 0].mean()), float(centres[:, 1].mean()), radius_px), weigh_apart, centres
        )
    else:
        limb = turn.sharpen(limb, weigh)
    return trusted(limb, centres, _off_ellipse_px(centres), factor, str(stack.paths[0].parent))


def trusted(limb: Limb, centres_px: F64, scatter_px: float, factor: int, source: str) -> Circle:
    """Return the circle in full pictures, if it is one.

    Parameters
    ----------
    limb : the circle in shrunk pictures
    centres_px : (N, 2) where single pictures put its centre
    scatter_px : how far, in these, single pictures put it from where the rest would have it
    factor : by how much they are shrunk
    source : names the pictures in the error

    Raises
    ------
    InputError
        Too little of the rim agrees on it, the pictures contradict each other, or it is carried round too far.
    """
    if not (limb.agreement >= _LEAST_AGREEMENT and limb.evidence >= _LEAST_EVIDENCE):
        raise InputError(
            f"{source}: no round outline found (at best {limb.agreement:.0%} of a rim agrees on a circle); {_NEXT_STEP}"
        )
    most_share = _MOST_WOBBLE_SHARE if limb.evidence >= _PLAIN_EVIDENCE else _MOST_SCATTER_SHARE
    if not scatter_px <= max(most_share * limb.radius_px, _MOST_SCATTER_PX):
        raise InputError(
            f"{source}: no round outline found (single pictures put the likeliest circle, of radius "
            f"{limb.radius_px * factor:.4g} px, {scatter_px * factor:.3g} px away from each other); {_NEXT_STEP}"
        )
    offset_px = float(np.median(np.linalg.norm(centres_px - (limb.x_px, limb.y_px), axis=1)))
    if not offset_px <= max(_MOST_OFFSET_SHARE * limb.radius_px, _MOST_SCATTER_PX):
        raise InputError(
            f"{source}: what turns there is no sphere on the axis (a circle of radius {limb.radius_px * factor:.4g} px "
            f"that moves round by {offset_px * factor:.3g} px); centre the sample, or {_NEXT_STEP}"
        )
    return Circle(limb.x_px * factor, limb.y_px * factor, limb.radius_px * factor)


def _off_ellipse_px(centres_px: F64) -> float:
    """RMS distance of centres (N, 2) from an even motion round an ellipse, near which a sample off the axis stays."""
    turn_rad = 2 * np.pi * np.arange(len(centres_px)) / len(centres_px)
    design = np.stack([np.ones(len(turn_rad)), np.cos(turn_rad), np.sin(turn_rad)], axis=1)
    left = centres_px - design @ np.linalg.lstsq(design, centres_px, rcond=None)[0]
    return float(np.sqrt(np.sum(left**2) / max(len(left) - 3, 1)))
