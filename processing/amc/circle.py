"""The sphere's silhouette in the pictures of a turn, to a fraction of a pixel and without a click.

A coarse search (`circle_search`) proposes circles. Around each, every picture is unrolled along radii, and each sector
says where its edge lies by maximum likelihood of a small model: outside, nothing turns and the picture is smooth;
inside, the light is a smooth function of n_z = √(1 − (ρ/ρ₀)²). That n_z falls steeply at the rim is part of the model,
so that a limb that darkens towards a dark background does not draw the edge inwards. All that in linear light, for
pixels on the edge mix light, not codes. A robust circle goes through the sectors.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from litrig.base.radiometry import encode_srgb
from processing.amc.circle_search import candidates
from processing.amc.limb import Limb, find_edges, fit_limb
from processing.stack import Stack

F32 = NDArray[np.float32]

_MOST_FRAMES = 12
_LONGEST_SIDE_PX = 1600
_SHARES_OF_RADIUS = (0.12, 0.05, 0.02, 0.015)
# Checkers without a sphere were seen to reach 0.68, spheres in clutter 0.86.
_LEAST_AGREEMENT, _BEYOND_DOUBT = 0.75, 0.9
_NEXT_STEP = "give --circle X Y R"
SMALLEST_RADIUS_PX = 4.0


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
    """Find the silhouette of the sphere that turns in these pictures.

    Parameters
    ----------
    stack : pictures in the order of their turntable angles; a dozen of them, spread over the turn, are looked at

    Raises
    ------
    InputError
        No circle stands out.
    """
    source = str(stack.paths[0].parent)
    factor = max(1, -(-max(stack.shape) // _LONGEST_SIDE_PX))
    greys = _load_greys(stack, factor, report)
    best = Limb(0, 0, 0)
    for guess in candidates(encode_srgb(greys)):
        best = max(best, _refine(greys, Limb(*guess)), key=lambda limb: limb.agreement)
        if best.agreement >= _BEYOND_DOUBT:
            break
    if best.agreement < _LEAST_AGREEMENT:
        raise InputError(
            f"{source}: no round outline found (at best {best.agreement:.0%} of a rim agrees on a circle); {_NEXT_STEP}"
        )
    return Circle(best.x_px * factor, best.y_px * factor, best.radius_px * factor)


def _refine(greys: F32, limb: Limb) -> Limb:
    for share in _SHARES_OF_RADIUS:
        limb = fit_limb(limb, find_edges(greys, limb, share))
    return limb


def _load_greys(stack: Stack, factor: int, report: Report) -> F32:
    """Read pictures in linear light, mean of the channels, shrunk by a whole factor; (N, H/f, W/f)."""
    picks = np.unique(np.linspace(0, len(stack), _MOST_FRAMES, endpoint=False).astype(int))
    height, width = (side // factor for side in stack.shape)
    greys = np.zeros((len(picks), height, width), np.float32)
    for place, index in enumerate(picks):
        whole = stack.linear(int(index)).mean(axis=-1)[: height * factor, : width * factor]
        greys[place] = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA)
        report(Progress("finding the sphere", place + 1, len(picks), stack.paths[index].name))
    return greys
