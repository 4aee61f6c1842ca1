"""The rim of a mirror ball to a fraction of a pixel.

Near its rim a ball mirrors what lies behind it, squeezed, so that no model of its light holds there but the simplest:
one level just inside, one just outside, in each direction for itself. Where the pixels between mix the two by halves is
the rim. Directions without contrast have no say, and those that follow another edge are outvoted.
"""

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from processing.outline.circle import SMALLEST_RADIUS_PX, Circle
from processing.ptm.lights.mirror import stretch

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_STEP_PX = 0.25
_BAND_SHARES, _NARROWEST_PX = (0.12, 0.06, 0.03, 0.015), 3.0
_FEWEST_SECTORS, _MOST_SECTORS, _SECTOR_PX, _LINES = 60, 360, 3.0, 3
_GAP_PX = 1.0
_LEAST_CONTRAST = 4.0
_LEAST_SHARE, _LEAST_ARC = 0.2, 3
_AGREES_PX, _AGREES_SHARE = 0.7, 0.01
_RESWEEPS, _SOFT_PX = 12, 0.15
_DARK_QUANTILE, _BRIGHT_QUANTILE, _DARK_SHARE, _DARKEST = 0.01, 0.9, 0.005, 1e-12


class Rim(NamedTuple):
    """An outline, and the share of it, 0..1, that is seen where the circle says."""

    circle: Circle
    agreement: float


def usual_light(crops: F32) -> F32:
    """Return the geometric mean (H, W) over lamps, in which a highlight or a shadow of one of them does not rule.

    Parameters
    ----------
    crops : (N, H, W) linear light
    """
    light: F32 = np.exp(logarithms(crops).mean(axis=0)).astype(np.float32)
    return light


def logarithms(greys: F32) -> F32:
    """Return log(light), less steep below the darkest that there is, where noise and rounding are all."""
    positive = greys[greys > 0]
    if not positive.size:
        return np.zeros_like(greys)
    darkest, bright = (float(light) for light in np.quantile(positive, [_DARK_QUANTILE, _BRIGHT_QUANTILE]))
    steep: F32 = np.log(np.maximum(greys, 0) + np.float32(darkest + _DARK_SHARE * bright))
    return steep


def fit_rim(light: F32, circle: Circle, camera: CameraModel | None = None) -> Rim | None:
    """Fit an outline, starting from a circle that is off by a tenth of its radius at most.

    Parameters
    ----------
    light : (H, W) linear
    camera : of perspective pictures, where the outline is an ellipse; circle and camera in the picture's pixels

    Returns
    -------
    rim : centre and mean radius of the outline; None where too little of a rim shows
    """
    rim = Rim(circle, 0.0)
    for share in _BAND_SHARES:
        found = _fit(light, rim.circle, max(share * circle.radius_px, _NARROWEST_PX), camera)
        if found is None:
            return None
        rim = found
    return rim


def _fit(light: F32, circle: Circle, band_px: float, camera: CameraModel | None) -> Rim | None:
    amount, towards = stretch(circle, camera)
    count = int(np.clip(2 * np.pi * circle.radius_px / _SECTOR_PX, _FEWEST_SECTORS, _MOST_SECTORS))
    azimuth = 2 * np.pi * (np.arange(count) + 0.5) / count
    expected = circle.radius_px * (1 + amount * np.cos(2 * (azimuth - towards)))
    offsets = np.arange(-2 * band_px, 2 * band_px + _STEP_PX / 2, _STEP_PX)
    profiles = _profiles(light, circle, azimuth, expected, offsets)
    rim, contrast = _edges(profiles, offsets, band_px)
    seen = contrast > _LEAST_CONTRAST
    spread = len(np.unique((azimuth[seen] * 8 / (2 * np.pi)).astype(int)))
    if seen.mean() < _LEAST_SHARE or spread < _LEAST_ARC:
        return None
    design = np.stack([np.cos(azimuth), np.sin(azimuth), np.ones(count)], axis=1)[seen]
    shift = np.array([0.0, 0.0, float(np.median(rim[seen]))])
    for _ in range(_RESWEEPS):
        left = rim[seen] - design @ shift
        soft_px = max(1.4826 * float(np.median(np.abs(left))), _SOFT_PX)
        weight = 1 / (1 + (left / soft_px) ** 2) ** 2
        shift = np.linalg.lstsq(design * weight[:, None], rim[seen] * weight, rcond=None)[0]
    fitted = Circle(circle.x_px + float(shift[0]), circle.y_px + float(shift[1]), circle.radius_px + float(shift[2]))
    if not (np.abs(shift).max() < 2 * band_px and fitted.radius_px >= SMALLEST_RADIUS_PX):
        return None
    agrees = np.abs(rim[seen] - design @ shift) < max(_AGREES_SHARE * circle.radius_px, _AGREES_PX)
    return Rim(fitted, float(np.count_nonzero(agrees)) / count)


def _profiles(light: F32, circle: Circle, azimuth: F64, expected_px: F64, offsets_px: F64) -> F64:
    """Sample lines across the expected rim, each a mean of a few beside each other; (A, T)."""
    beside = (np.arange(_LINES) - (_LINES - 1) / 2) / _LINES * (azimuth[1] - azimuth[0])
    turn = (azimuth[:, None] + beside)[..., None]
    radius = (expected_px[:, None] + offsets_px)[:, None, :]
    columns = (circle.x_px + radius * np.cos(turn) - 0.5).astype(np.float32)
    rows = (circle.y_px + radius * np.sin(turn) - 0.5).astype(np.float32)
    flat = (len(azimuth) * _LINES, len(offsets_px))
    sampled = cv2.remap(
        light, columns.reshape(flat), rows.reshape(flat), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    lines: F64 = sampled.reshape(len(azimuth), _LINES, -1).mean(axis=1, dtype=np.float64)
    return lines


def _edges(profiles: F64, offsets_px: F64, band_px: float) -> tuple[F64, F64]:
    """Find in each profile the strongest step within the band: its place (A,), and its height over the noise (A,)."""
    side = max(int(band_px / _STEP_PX) // 2, 4)
    gap = int(_GAP_PX / _STEP_PX)
    sums = np.concatenate([np.zeros((len(profiles), 1)), np.cumsum(profiles, axis=1)], axis=1)
    squares = np.concatenate([np.zeros((len(profiles), 1)), np.cumsum(profiles**2, axis=1)], axis=1)
    places = np.nonzero(np.abs(offsets_px) <= band_px)[0]
    places = places[(places >= gap + side) & (places + gap + side < profiles.shape[1])]
    inner, outer = (places - gap - side, places - gap), (places + gap + 1, places + gap + 1 + side)
    levels = [(sums[:, stop] - sums[:, start]) / side for start, stop in (inner, outer)]
    noise = [
        (squares[:, stop] - squares[:, start]) / side - level**2
        for (start, stop), level in zip((inner, outer), levels, strict=True)
    ]
    deviation = np.sqrt(np.maximum(noise[0] + noise[1], 0) / 2)
    # Quantisation and rounding keep a flat profile from being infinitely sure.
    floor = 1e-3 * profiles.mean(axis=1, keepdims=True) + _DARKEST
    step = np.abs(levels[1] - levels[0])
    best = np.argmax(step - deviation, axis=1)
    lines = np.arange(len(profiles))
    low, high = levels[0][lines, best], levels[1][lines, best]
    centre = places[best]
    window = centre[:, None] + np.arange(-gap, gap + 1)
    outside = (profiles[lines[:, None], window] - low[:, None]) / np.where(high == low, 1, high - low)[:, None]
    # A step blurred by anything symmetric, read off its area: what is not yet outside lies inside.
    rim = offsets_px[centre] + _STEP_PX * ((2 * gap + 1) / 2 - outside.clip(-0.5, 1.5).sum(axis=1))
    return rim, step[lines, best] / (deviation[lines, best] + floor[:, 0])
