"""The circle that the sectors of a rim agree on: the greatest product of their likelihoods, each with a chance to err.

Near an assumed circle the rim is ρ(φ) = r + Δx cos φ + Δy sin φ, with φ from x to the picture's y. A coarse grid over
(Δx, Δy, r) finds the summit, Newton's method climbs it; for many pictures at once where each has its own circle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.outline.limb import RimCosts

F64 = NDArray[np.float64]

# A sector that sees something else has this chance to lie anywhere.
_ELSEWHERE = 0.2
# No sector knows the rim better than this, whatever its noise says.
_SUREST_PX = 0.15
_ELSEWHERE_REACH_PX = 6.0
_GRID_STEPS, _STARTS = 6, 5
_BLURS_PX = (1.5, 0.7, 0.3, 0.0)
_MARGIN = 4
_CLIMBS, _LONGEST_STEP_PX = 6, 1.0


@dataclass(frozen=True)
class Limb:
    """A circle in pixels, and the share of its rim, 0..1, that agrees with it; sure sectors count more."""

    x_px: float
    y_px: float
    radius_px: float
    agreement: float = 0.0
    evidence: float = -np.inf


def fit_limb(limb: Limb, costs: RimCosts) -> Limb:
    """Fit a circle to the sectors; `limb` is the circle around which the pictures were unrolled."""
    chances = _chances(costs)
    starts = _best_of_grid(costs, chances, limb.radius_px)
    # Blur leads out of small pits, and sometimes away from a narrow summit.
    climbed = [
        _climb(costs, chances[None].repeat(len(starts), 0), starts, 3, blurs) for blurs in (_BLURS_PX, _BLURS_PX[-2:])
    ]
    shifts, heights = (np.concatenate([climb[part] for climb in climbed]) for part in (0, 2))
    shift = shifts[int(np.argmax(heights))]
    agreement, evidence = _agreement(costs, chances, costs.towards @ shift)
    return Limb(limb.x_px + float(shift[0]), limb.y_px + float(shift[1]), float(shift[2]), agreement, evidence)


def fit_each(costs: RimCosts, start: F64, free: int) -> tuple[F64, F64]:
    """Fit a circle to every picture by itself.

    Parameters
    ----------
    costs : of every picture, cost (N, A, T)
    start : (N, 3) Δx, Δy, r
    free : 3, or 2 to keep the radius

    Returns
    -------
    shifts : (N, 3) Δx, Δy, r
    deviation_px : (N,) standard deviation of a coordinate of the centre, from the curvature of the likelihood
    """
    return _climb(costs, _chances(costs), start, free, _BLURS_PX)[:2]


def _chances(costs: RimCosts) -> F64:
    """Return the chance that the rim lies at each trial; (…, A, T)."""
    chances = np.exp(costs.cost.min(axis=-1, keepdims=True) - costs.cost)
    chances /= chances.sum(axis=-1, keepdims=True)
    blurred: F64 = ndimage.gaussian_filter1d(chances, max(_SUREST_PX / costs.step_px, 0.5), axis=-1, mode="constant")
    return blurred


def _climb(costs: RimCosts, chances: F64, start: F64, free: int, blurs_px: Sequence[float]) -> tuple[F64, F64, F64]:
    """Newton's method on the logarithm, first of a blurred landscape, then of sharper ones; never downhill."""
    towards = costs.towards[:, :free]
    shifts, normal, height = start.copy(), np.zeros((len(start), free, free)), np.zeros(len(start))
    for blur_px in blurs_px:
        heights = _heights(costs, chances, blur_px)
        longest = np.full((len(start), 1), _LONGEST_STEP_PX)
        height, slope, bend = _terrain(costs, heights, shifts)
        for _ in range(_CLIMBS):
            normal = np.einsum("na,af,ag->nfg", bend, towards, towards) + 1e-3 * np.eye(free)
            step = np.linalg.solve(normal, (slope @ towards)[..., None])[..., 0]
            length = np.linalg.norm(step, axis=-1, keepdims=True)
            tried = shifts.copy()
            tried[:, :free] += step * np.minimum(1, longest / np.maximum(length, 1e-9))
            found = _terrain(costs, heights, tried)
            higher = (found[0] >= height)[:, None]
            longest = np.where(higher, longest, np.minimum(longest, length) / 3)
            shifts = np.where(higher, tried, shifts)
            height, slope, bend = (
                np.where(higher[:, 0] if new.ndim == 1 else higher, new, old)
                for new, old in zip(found, (height, slope, bend), strict=True)
            )
    inverse = np.linalg.inv(normal)
    deviation: F64 = np.sqrt((inverse[:, 0, 0] + inverse[:, 1, 1]) / 2)
    return shifts, deviation, height


def _heights(costs: RimCosts, chances: F64, blur_px: float) -> F64:
    """Logarithm of the chances relative to even ones, with the chance that the sector errs; (…, A, T and margins)."""
    blurred = (
        ndimage.gaussian_filter1d(chances, blur_px / costs.step_px, axis=-1, mode="constant") if blur_px else chances
    )
    heights = np.log((1 - _ELSEWHERE) * blurred * blurred.shape[-1] + _ELSEWHERE)
    # A rim beyond the trials is elsewhere.
    padding = [(0, 0)] * (heights.ndim - 1) + [(_MARGIN, _MARGIN)]
    return np.pad(heights, padding, constant_values=np.log(_ELSEWHERE))


def _terrain(costs: RimCosts, heights: F64, shifts: F64) -> tuple[F64, F64, F64]:
    """Sum of the heights (N, A, T) along rims (N,), and each sector's first and negated second derivative (N, A)."""
    place = (shifts @ costs.towards.T - costs.trial_px[0]) / costs.step_px + _MARGIN
    place = np.clip(place, 1.0, heights.shape[-1] - 2.001)
    low = place.astype(int)
    part = place - low
    pictures, sectors = np.ogrid[: heights.shape[0], : heights.shape[1]]
    before, here, there, after = (
        heights[pictures, sectors, np.clip(low + k, 0, heights.shape[-1] - 1)] for k in (-1, 0, 1, 2)
    )
    height = ((1 - part) * here + part * there).sum(axis=-1)
    slope = ((1 - part) * (there - before) + part * (after - here)) / (2 * costs.step_px)
    bend = -((1 - part) * (before - 2 * here + there) + part * (here - 2 * there + after)) / costs.step_px**2
    return height, slope, np.maximum(bend, 0)


def _best_of_grid(costs: RimCosts, chances: F64, radius_px: float) -> F64:
    """Start (K, 3: Δx, Δy, r) where one is, and where a coarse grid is best with chances as blurred as it is coarse."""
    reach = float(costs.trial_px[-1] - costs.trial_px[0]) / 2
    heights = _heights(costs, chances, reach / _GRID_STEPS / 1.5)
    line = np.linspace(-reach, reach, 2 * _GRID_STEPS + 1)
    grid = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    place = np.rint((radius_px + grid @ costs.towards.T - costs.trial_px[0]) / costs.step_px).astype(int)
    place = np.clip(place + _MARGIN, 0, heights.shape[1] - 1)
    scores = heights[np.arange(len(heights)), place].sum(axis=1)
    best = grid[np.argsort(scores)[-_STARTS:]]
    starts: F64 = np.vstack([np.zeros(3), best]) + np.array([0.0, 0.0, radius_px])
    return starts


def _agreement(costs: RimCosts, chances: F64, rim: F64) -> tuple[float, float]:
    """Share of the sectors that are likelier to see the circle than anything else, and the mean log of how much."""
    place = np.clip(np.rint((rim - costs.trial_px[0]) / costs.step_px).astype(int), 0, len(costs.trial_px) - 1)
    density = chances[np.arange(len(chances)), place] / costs.step_px * _ELSEWHERE_REACH_PX
    agrees = (1 - _ELSEWHERE) * density + _ELSEWHERE
    return float(np.mean(1 - _ELSEWHERE / agrees)), float(np.mean(np.log(agrees)))
