"""The rim of a sphere in a stack of pictures: how likely it lies where along each radius, and the circle through that.

Every picture is unrolled along radii around an assumed centre, and each sector weighs trial radii by the likelihood of
a small model. Inside, the light is a smooth function of n_z = √(1 − (ρ/ρ₀)²), which falls steeply at the rim: a limb
that darkens towards a dark background does not draw the edge inwards. Outside, it is nearly constant. What either side
leaves unexplained is noise of its own strength, so that clutter, weave or a printed board that turns along are no edge
in themselves, and their beginning is one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_MOST_SECTORS, _FEWEST_SECTORS, _SECTOR_PX = 120, 32, 3.0
_LINES_PER_SECTOR = 6
_STEP_PX = 0.5
_FINER = 5
SHARP_PX = 0.6
"""Blur of a picture in focus, as a standard deviation."""
_WINDOW_SHARE, _NARROWEST_WINDOW_PX = 0.06, 8.0
# Codes of eight bits are never surer than this, nor is the model: without it, noise-free pictures would take the place
# where a highlight fades for the rim.
_CODE_SHARE, _MISFIT_SHARE = 0.3, 0.03
# Few terms draw the rim outwards by what they overlook, many by what they make up. What turns has the sharper lights.
_STILL_TERMS, _TURNING_TERMS, _OUTER_TERMS = 3, 4, 2


@dataclass(frozen=True)
class Profiles:
    """Light along radii, sector by sector.

    Attributes
    ----------
    azimuth_rad : (A,) from x to the picture's y, which runs down
    radius_px : (P,) evenly spaced, from the assumed centre
    light : (N, A, P, C) linear
    """

    azimuth_rad: F64
    radius_px: F64
    light: F32

    def every(self, step: int) -> "Profiles":
        """Return every so many sectors."""
        return Profiles(self.azimuth_rad[::step], self.radius_px, self.light[:, ::step])


@dataclass(frozen=True)
class RimCosts:
    """Negative log likelihood of the rim's place, sector by sector.

    Attributes
    ----------
    azimuth_rad : (A,)
    trial_px : (T,) evenly spaced radii
    cost : (A, T), or (N, A, T) where each picture is weighed by itself
    """

    azimuth_rad: F64
    trial_px: F64
    cost: F64

    @property
    def step_px(self) -> float:
        """Distance between trials."""
        return float(self.trial_px[1] - self.trial_px[0])

    @property
    def towards(self) -> F64:
        """How far each sector's rim moves with the circle's x, y and radius; (A, 3)."""
        return np.stack([np.cos(self.azimuth_rad), np.sin(self.azimuth_rad), np.ones(len(self.azimuth_rad))], axis=1)


Weigh = Callable[[Profiles, F64, float], RimCosts]
"""A way of weighing trial radii, given a blur in pixels."""


def unroll(pictures: F32, centres_px: F64, radius_px: float, reach_px: float) -> Profiles:
    """Sample pictures along radii, as far around the assumed rim as trials up to `reach_px` from it need.

    Parameters
    ----------
    pictures : (N, H, W, C) linear light
    centres_px : (N, 2) the circle's centre x, y in each picture
    """
    half_window = max(reach_px + _WINDOW_SHARE * radius_px, _NARROWEST_WINDOW_PX)
    radii = np.arange(max(radius_px - half_window, 1.0), radius_px + half_window, _STEP_PX)
    sectors = int(np.clip(2 * np.pi * radius_px / _SECTOR_PX, _FEWEST_SECTORS, _MOST_SECTORS))
    fine = 2 * np.pi * (np.arange(sectors * _LINES_PER_SECTOR) + 0.5) / (sectors * _LINES_PER_SECTOR)
    right, down = np.cos(fine)[:, None] * radii - 0.5, np.sin(fine)[:, None] * radii - 0.5
    light = np.zeros((len(pictures), sectors, len(radii), pictures.shape[-1]), np.float32)
    for place, (picture, (x_px, y_px)) in enumerate(zip(pictures, centres_px, strict=True)):
        columns, rows = (right + x_px).astype(np.float32), (down + y_px).astype(np.float32)
        lines = cv2.remap(picture, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        light[place] = lines.reshape(sectors, _LINES_PER_SECTOR, len(radii), -1).mean(axis=1)
    return Profiles(fine.reshape(sectors, -1).mean(axis=1), radii, light)


def weigh_turn(profiles: Profiles, trial_px: F64, blur_px: float = SHARP_PX) -> RimCosts:
    """Weigh trial radii by a whole turn: its mean in each colour, and what each picture adds to that in grey.

    What is in clutter or without contrast in one of them is flat over the trials there, and has no say.
    """
    mean = np.moveaxis(profiles.light.mean(axis=0), -1, 0)
    greys = profiles.light.mean(axis=-1)
    added = greys - greys.mean(axis=0)
    mean_floor, added_floor = _floor(mean), _floor(added)
    turning = _turning_terms(
        added, added_floor, _Sides(profiles.radius_px, float(trial_px[len(trial_px) // 2]), blur_px)
    )
    sides = (_Sides(profiles.radius_px, float(trial), blur_px) for trial in trial_px)
    cost = [
        _noise_cost(mean, mean_floor, side, _STILL_TERMS, _OUTER_TERMS).sum(axis=0)
        + _noise_cost(added, added_floor, side, _TURNING_TERMS, turning, shared=True)[0]
        for side in sides
    ]
    return RimCosts(profiles.azimuth_rad, trial_px, np.stack(cost, axis=-1))


def _turning_terms(added: F32, floor: F32, sides: "_Sides") -> int:
    """Return how many terms the light outside needs to turn: none unless a board turns along (Schwarz's criterion)."""
    still, turning = (
        _noise_cost(added, floor, sides, _TURNING_TERMS, terms, shared=True) for terms in (0, _OUTER_TERMS)
    )
    samples = _STEP_PX * added.shape[-1]
    gain = still - turning - 0.5 * _OUTER_TERMS * len(added) * np.log(samples)
    return _OUTER_TERMS if np.median(gain) > 0 else 0


def weigh_each(profiles: Profiles, trial_px: F64, blur_px: float = SHARP_PX) -> RimCosts:
    """Weigh trial radii by each picture for itself, (N, A, T): nothing need stay still."""
    greys = profiles.light.mean(axis=-1)
    sides = (_Sides(profiles.radius_px, float(trial), blur_px) for trial in trial_px)
    floor = _floor(greys)
    cost = [_noise_cost(greys, floor, side, _STILL_TERMS, _OUTER_TERMS) for side in sides]
    return RimCosts(profiles.azimuth_rad, trial_px, np.stack(cost, axis=-1))


def weigh_apart(profiles: Profiles, trial_px: F64, blur_px: float = SHARP_PX) -> RimCosts:
    """Join what the pictures say by themselves, (A, T): where a rim moves on the pixels, no mean of a turn is sharp."""
    each = weigh_each(profiles, trial_px, blur_px)
    return RimCosts(each.azimuth_rad, each.trial_px, each.cost.sum(axis=0))


class _Sides:
    """What a rim at one radius makes of the samples of a line: smooth light on either side, and whose they are.

    Attributes
    ----------
    within : (P,) the disc's share of each sample, blurred as a lens does
    """

    def __init__(self, radii: F64, trial_px: float, blur_px: float) -> None:
        fine = _STEP_PX / _FINER
        # Samples of a finer line, of which every fifth is a sample of `radii`, with room for the blur at both ends.
        margin = _FINER * int(np.ceil(4 * blur_px / _STEP_PX))
        line = radii[0] + fine * (np.arange(_FINER * (len(radii) - 1) + 1 + 2 * margin) - margin)
        within = np.clip((trial_px - line) / fine + 0.5, 0, 1)
        normal_z = np.sqrt(np.maximum(1 - (line / trial_px) ** 2, 0))
        far = (line - trial_px) / trial_px
        inner = [within * normal_z**power for power in range(_TURNING_TERMS)]
        outer = [(1 - within) * far**power for power in range(_OUTER_TERMS)]
        columns = np.stack(inner + outer, axis=1)
        blurred = ndimage.gaussian_filter1d(columns, blur_px / fine, axis=0, mode="nearest")
        self._smooth = blurred[margin : len(line) - margin : _FINER]
        self.within = self._smooth[:, 0].astype(np.float32)

    def basis(self, inner: int, outer: int) -> F32:
        """Return an orthonormal basis (P, inner + outer) of 1, n_z, n_z² … inside and of 1, ρ outside."""
        chosen = [*range(inner), *range(_TURNING_TERMS, _TURNING_TERMS + outer)]
        return np.linalg.qr(self._smooth[:, chosen])[0].astype(np.float32)


def _noise_cost(light: F32, floor: F32, sides: _Sides, inner: int, outer: int, *, shared: bool = False) -> F64:
    """Cost (M, A) of profiles (M, A, P); `shared` ones have one noise and one cost (1, A).

    A sample that is the disc's by the share w has the variance w²·σ² (inside) + (1 − w)²·σ² (outside).
    """
    basis = sides.basis(inner, outer)
    left = light - (light @ basis) @ basis.T
    left *= left
    freedom = 1
    if shared:
        left, floor, freedom = left.mean(axis=0, keepdims=True), floor.mean(axis=0, keepdims=True), len(light) - 1
    noise = np.zeros_like(left)
    for share in (sides.within**2, (1 - sides.within) ** 2):
        noise += ((left @ share) / max(float(share.sum()), 1e-3) + floor)[..., None] * share
    left += floor[..., None]
    left /= noise
    left += np.log(noise, out=noise)
    cost: F64 = 0.5 * _STEP_PX * freedom * left.sum(axis=-1, dtype=np.float64)
    return cost


def _floor(light: F32) -> F32:
    """Variance that stays unexplained in any case; (M, A)."""
    floor: F32 = (_CODE_SHARE / 255) ** 2 + _MISFIT_SHARE**2 * light.var(axis=-1)
    return floor
