"""The sphere's outline, picture by picture: found without a click, to a fraction of a pixel.

A coarse search (`circle_search`) proposes circles, the likelihood of the rim (`limb`, `rim_fit`) refines them over the
whole turn, and each picture then says by itself where its circle lies, for a sample mounted off the axis moves round.
All that in linear light: pixels on the edge mix light, not codes.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.progress import Progress, Report
from processing.outline.circle_search import candidates
from processing.outline.limb import SHARP_PX, Profiles, RimCosts, Weigh, unroll, weigh_apart, weigh_each, weigh_turn
from processing.outline.rim_fit import Limb, fit_each, fit_limb
from processing.stack import Stack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_LONGEST_SIDE_PX = 1200
_COARSE_SHARE, _FINE_SHARE, _SHARP_SHARE = 0.12, 0.04, 0.02
_NARROWEST_REACH_PX, _TRIAL_STEP_PX, _MOST_TRIALS = 3.0, 0.25, 16
_EACH_SHARES = (0.1, 0.03)
_BEYOND_DOUBT = 2.15
_FEWEST_PX = 3.0
_WHITE_QUANTILE, _BLACK, _SPARSE = 0.995, 1e-6, 3
_BLURS_PX = (SHARP_PX, 1.0, 1.5, 2.2, 3.2)
_FEW_SECTORS = 4
_MOST_ROUNDS, _AT_REST_PX = 3, 0.3


class Turn:
    """Some pictures of a turn, in linear light and shrunk where they are large.

    Attributes
    ----------
    pictures : (N, H, W, C)
    """

    def __init__(self, pictures: F32) -> None:
        self.pictures = pictures

    def find(self) -> tuple[Limb, Weigh]:
        """Return the best of the proposed circles, and the way of weighing that knows most about it."""
        best, way = Limb(0, 0, 0, evidence=0), weigh_turn
        guesses = candidates(self.pictures.mean(axis=-1))
        for weigh in (weigh_turn, weigh_apart):
            for guess in guesses:
                limb = Limb(*guess)
                for share in (_COARSE_SHARE, _FINE_SHARE, _SHARP_SHARE):
                    limb = self._refine(limb, share, weigh)
                if limb.evidence >= _BEYOND_DOUBT:
                    return limb, weigh
                # A highlight may be rounder than a rim in the dark, but it is smaller.
                if limb.evidence * limb.radius_px > best.evidence * best.radius_px:
                    best, way = limb, weigh
        return best, way

    def sharpen(self, limb: Limb, weigh: Weigh, centres_px: F64 | None = None) -> Limb:
        """Refine a circle with the blur that the pictures have; `centres_px` (N, 2), if it moves."""
        blur_px = self._blur_px(limb, weigh, centres_px)
        for _ in range(_MOST_ROUNDS):
            before, limb = limb, self._refine(limb, _SHARP_SHARE, weigh, centres_px, blur_px)
            moved = np.array([limb.x_px - before.x_px, limb.y_px - before.y_px])
            if max(float(np.abs(moved).max()), abs(limb.radius_px - before.radius_px)) < _AT_REST_PX:
                break
            if centres_px is not None:
                centres_px = centres_px + moved
        return limb

    def _refine(
        self, limb: Limb, share: float, weigh: Weigh, centres_px: F64 | None = None, blur_px: float = SHARP_PX
    ) -> Limb:
        if limb.radius_px < _FEWEST_PX:
            return Limb(0, 0, 0)
        profiles, trials = self._around(limb, share, centres_px)
        return fit_limb(limb, weigh(profiles, trials, blur_px))

    def _blur_px(self, limb: Limb, weigh: Weigh, centres_px: F64 | None) -> float:
        """Choose the blur with which the middling of a few sectors fits best."""
        if limb.radius_px < _FEWEST_PX:
            return SHARP_PX
        profiles, trials = self._around(limb, _FINE_SHARE, centres_px)
        few = profiles.every(_FEW_SECTORS)
        return min(_BLURS_PX, key=lambda blur_px: _misfit(limb, weigh(few, trials, blur_px)))

    def _around(self, limb: Limb, share: float, centres_px: F64 | None) -> tuple[Profiles, F64]:
        reach_px = max(share * limb.radius_px, _NARROWEST_REACH_PX)
        centres = np.tile([limb.x_px, limb.y_px], (len(self.pictures), 1)) if centres_px is None else centres_px
        return unroll(self.pictures, centres, limb.radius_px, reach_px), _trials(limb.radius_px, reach_px)

    def watch(self, limb: Limb) -> tuple[F64, F64, float]:
        """Fit each picture by itself: centres (N, 2), their deviation (N,), and the radius that most agree on."""
        centres = np.tile([limb.x_px, limb.y_px], (len(self.pictures), 1))
        deviation, radius_px = np.zeros(len(centres)), max(limb.radius_px, _FEWEST_PX)
        for share in _EACH_SHARES:
            reach_px = max(share * radius_px, _NARROWEST_REACH_PX)
            profiles = unroll(self.pictures, centres, radius_px, reach_px)
            costs = weigh_each(profiles, _trials(radius_px, reach_px))
            shifts = np.tile([0.0, 0.0, radius_px], (len(centres), 1))
            radius_px = max(float(np.median(fit_each(costs, shifts, 3)[0][:, 2])), _FEWEST_PX)
            shifts[:, 2] = radius_px
            shifts, deviation = fit_each(costs, shifts, 2)
            centres = centres + shifts[:, :2]
        return centres, deviation, radius_px


def _misfit(limb: Limb, costs: RimCosts) -> float:
    """Cost of the middling sector at the rim that fits best."""
    fitted = fit_limb(limb, costs)
    rim = costs.towards @ np.array([fitted.x_px - limb.x_px, fitted.y_px - limb.y_px, fitted.radius_px])
    place = np.clip(np.rint((rim - costs.trial_px[0]) / costs.step_px).astype(int), 0, len(costs.trial_px) - 1)
    return float(np.median(costs.cost[np.arange(len(rim)), place]))


def _trials(radius_px: float, reach_px: float) -> F64:
    reach_px = min(reach_px, radius_px / 2)
    count = min(int(reach_px / _TRIAL_STEP_PX), _MOST_TRIALS)
    return radius_px + np.linspace(-reach_px, reach_px, 2 * count + 1)


def load_turn(stack: Stack, most_frames: int, report: Report) -> tuple[Turn, NDArray[np.int64], int]:
    """Read pictures spread over the stack; the turn, their places in the stack, and the whole factor they shrank by."""
    picks = np.unique(np.linspace(0, len(stack), most_frames, endpoint=False).astype(np.int64))
    first, factor = shrunk(stack.linear(int(picks[0])))
    pictures = np.zeros((len(picks), *first.shape), np.float32)
    for place, index in enumerate(picks):
        pictures[place] = shrunk(stack.linear(int(index)))[0] if place else first
        report(Progress("finding the sphere", place + 1, len(picks), stack.paths[index].name))
    return Turn(exposed(pictures)), picks, factor


def shrunk(picture: F32) -> tuple[F32, int]:
    """Shrink a large picture (H, W, C) by a whole factor, and say by which; what does not fill a pixel is cut off."""
    factor = max(1, -(-max(picture.shape[:2]) // _LONGEST_SIDE_PX))
    height, width = (side // factor for side in picture.shape[:2])
    if factor == 1:
        return picture, 1
    whole = picture[: height * factor, : width * factor]
    return cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32), factor


def exposed(pictures: F32) -> F32:
    """Scale linear light (..., H, W, C) so that its brightest parts are white, of which noise is a share."""
    white = max(float(np.quantile(pictures[..., ::_SPARSE, ::_SPARSE, :].mean(axis=-1), _WHITE_QUANTILE)), _BLACK)
    return (pictures / np.float32(white)).astype(np.float32)
