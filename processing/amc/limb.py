"""The rim of a sphere in a stack of pictures: where it lies along each radius, and the circle through that."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_SECTORS, _LINES_PER_SECTOR = 120, 6
_STEP_PX = 0.5
_TRIAL_STEP_PX = 0.25
_BLUR_PX = 0.6
_WINDOW_SHARE, _NARROWEST_WINDOW_PX = 0.12, 8.0
# Wide enough that sectors without an edge do not agree by chance.
_NARROWEST_REACH_PX = 4.0
_MOST_TRIALS = 80
_NEVER_PX = 1e6
# Codes of eight bits are never surer than this, nor is the model: without it, noise-free pictures would take the place
# where a highlight fades for the rim.
_CODE_VARIANCE = (0.3 / 255) ** 2
_MISFIT_SHARE = 0.03
# Few terms draw the rim outwards by what they overlook, many by what they make up. What turns has the sharper lights.
_STILL_TERMS, _INNER_TERMS = 3, 5
_TRIPLES = 300


@dataclass(frozen=True)
class Limb:
    """A circle in pixels, and the share of its rim, 0..1, that agrees with it to a pixel; sure sectors count more."""

    x_px: float
    y_px: float
    radius_px: float
    agreement: float = 0.0


@dataclass(frozen=True)
class Edges:
    """Where each sector puts the rim.

    Attributes
    ----------
    azimuth_rad : (A,) from x to the picture's y, which runs down
    radius_px : (A,) distance from the centre that was assumed
    deviation_px : (A,) how sure that is, as a standard deviation; very large where the sector sees no edge
    """

    azimuth_rad: F64
    radius_px: F64
    deviation_px: F64


def find_edges(greys: F32, limb: Limb, share: float) -> Edges:
    """Search each sector for the rim within ±share of the radius.

    The likelihood joins two readings with unknown noise each: the mean over the turn (piecewise smooth), and what each
    picture adds to it (nothing outside). Whichever is in clutter or without contrast is flat over the trials and
    has no say.

    Parameters
    ----------
    greys : (N, H, W) linear light
    """
    half_window = max((share + _WINDOW_SHARE) * limb.radius_px, _NARROWEST_WINDOW_PX)
    radii = np.arange(max(limb.radius_px - half_window, 1.0), limb.radius_px + half_window, _STEP_PX)
    reach_px = max(share * limb.radius_px, _NARROWEST_REACH_PX)
    trials = limb.radius_px + np.linspace(
        -reach_px, reach_px, min(2 * int(reach_px / _TRIAL_STEP_PX), _MOST_TRIALS) + 1
    )
    azimuth, profiles = _unroll(greys, limb, radii)
    mean = profiles.mean(axis=0, keepdims=True)
    cost = np.stack([_cost(mean, profiles - mean, radii, trial) for trial in trials], axis=-1)
    return _minima(azimuth, trials, cost)


def fit_limb(limb: Limb, edges: Edges) -> Limb:
    """Put a circle through the sectors' edges: the best of many triples, then reweighted least squares (Tukey).

    Near the old circle the rim is ρ(φ) = r + Δx cos φ + Δy sin φ.
    """
    seen = edges.deviation_px < _NEVER_PX
    if seen.sum() < 3:
        return Limb(limb.x_px, limb.y_px, limb.radius_px)
    design = np.stack([np.cos(edges.azimuth_rad), np.sin(edges.azimuth_rad), np.ones(len(seen))], axis=1)
    shift = _best_triple(design, edges, seen)
    for scale_px in (2.0, 1.0, 1.0, 0.7, 0.7):
        misfit = (edges.radius_px - design @ shift) / np.hypot(scale_px, edges.deviation_px)
        weights = np.where(seen, np.maximum(1 - (misfit / 3) ** 2, 0) ** 2, 0) / np.hypot(0.2, edges.deviation_px) ** 2
        root = np.sqrt(weights)
        shift = np.linalg.lstsq(design * root[:, None], np.where(seen, edges.radius_px, 0) * root, rcond=None)[0]
    agreeing = seen & (np.abs(edges.radius_px - design @ shift) < 1)
    say = 1 / np.hypot(0.1, edges.deviation_px) ** 2
    return Limb(
        limb.x_px + float(shift[0]),
        limb.y_px + float(shift[1]),
        float(shift[2]),
        float(np.sum(say * agreeing) / np.sum(say)),
    )


def _unroll(greys: F32, limb: Limb, radii: F64) -> tuple[F64, F64]:
    """Sample along radii; azimuths (A,), profiles (N, A, P)."""
    lines = _SECTORS * _LINES_PER_SECTOR
    fine = 2 * np.pi * (np.arange(lines) + 0.5) / lines
    columns = (limb.x_px + np.cos(fine)[:, None] * radii - 0.5).astype(np.float32)
    rows = (limb.y_px + np.sin(fine)[:, None] * radii - 0.5).astype(np.float32)
    sampled = [cv2.remap(grey, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE) for grey in greys]
    profiles = np.stack(sampled).reshape(len(greys), _SECTORS, _LINES_PER_SECTOR, len(radii)).mean(axis=2)
    return fine.reshape(_SECTORS, -1).mean(axis=1), profiles.astype(np.float64)


def _cost(mean: F64, added: F64, radii: F64, trial_px: float) -> F64:
    """Negative log likelihood of a rim at one radius, for every sector (A,)."""
    inside, outside = _basis(radii, trial_px)
    pixels = len(radii) * _STEP_PX
    still = _residual(mean, np.hstack([inside[:, :_STILL_TERMS], outside])) / len(radii) + _floor(
        mean - mean.mean(axis=-1, keepdims=True)
    )
    turning = _residual(added, inside) / (len(radii) * len(added)) + _floor(added)
    cost: F64 = 0.5 * pixels * (np.log(still) + (len(added) - 1) * np.log(turning))
    return cost


def _floor(varying: F64) -> F64:
    """Variance that stays unexplained in any case; (A,)."""
    floor: F64 = _CODE_VARIANCE + _MISFIT_SHARE**2 * np.mean(varying**2, axis=(0, -1))
    return floor


def _residual(profiles: F64, basis: F64) -> F64:
    """Sum of squares that the basis cannot explain, over pictures and samples; (A,)."""
    orthonormal = np.linalg.qr(basis)[0]
    explained = profiles @ orthonormal
    left: F64 = np.maximum((profiles**2).sum(axis=-1) - (explained**2).sum(axis=-1), 0).sum(axis=0)
    return left


def _basis(radii: F64, trial_px: float) -> tuple[F64, F64]:
    """Smooth light inside (1, n_z, … n_z⁴) and outside (1, ρ), blurred as a lens does; (P, 5) and (P, 2)."""
    fine = _STEP_PX / 5
    # Samples of a finer line whose every fifth is a sample of `radii`, with room for the blur at both ends.
    margin = 20
    line = radii[0] + fine * (np.arange(5 * (len(radii) - 1) + 1 + 2 * margin) - margin)
    within = np.clip((trial_px - line) / fine + 0.5, 0, 1)
    normal_z = np.sqrt(np.maximum(1 - (line / trial_px) ** 2, 0))
    far = (line - trial_px) / trial_px
    columns = [within * normal_z**power for power in range(_INNER_TERMS)] + [1 - within, (1 - within) * far]
    blurred = ndimage.gaussian_filter1d(np.stack(columns, axis=1), _BLUR_PX / fine, axis=0, mode="nearest")
    sampled = blurred[margin : len(line) - margin : 5]
    return sampled[:, :_INNER_TERMS], sampled[:, _INNER_TERMS:]


def _minima(azimuth: F64, trials: F64, cost: F64) -> Edges:
    """Find each sector's best trial, refined by a parabola whose curvature is the information."""
    best = np.argmin(cost, axis=1)
    inner = np.clip(best, 1, len(trials) - 2)
    sectors = np.arange(len(cost))
    before, middle, after = (cost[sectors, inner + offset] for offset in (-1, 0, 1))
    curvature = before - 2 * middle + after
    found = (best == inner) & (curvature > 0)
    step = trials[1] - trials[0]
    offset = np.where(found, 0.5 * (before - after) / np.where(found, curvature, 1), 0)
    deviation = np.where(found, step / np.sqrt(np.where(found, curvature, 1)), _NEVER_PX)
    return Edges(azimuth, trials[inner] + offset * step, deviation)


def _best_triple(design: F64, edges: Edges, seen: NDArray[np.bool_]) -> F64:
    """Try circles through three sectors each; the one that most agree with, weighed by how sure they are."""
    random = np.random.default_rng(0)
    places = np.flatnonzero(seen)
    say = 1 / np.hypot(0.5, edges.deviation_px[places])
    picks = np.array([random.choice(places, 3, replace=False, p=say / say.sum()) for _ in range(_TRIPLES)])
    solvable = np.abs(np.linalg.det(design[picks])) > 0.2
    if not solvable.any():
        return np.array([0.0, 0.0, float(np.median(edges.radius_px[places]))])
    shifts = np.linalg.solve(design[picks[solvable]], edges.radius_px[picks[solvable], None])[..., 0]
    agrees = np.abs(edges.radius_px[places] - shifts @ design[places].T) < 1.5
    best: F64 = shifts[int(np.argmax((agrees * say).sum(axis=1)))]
    return best
