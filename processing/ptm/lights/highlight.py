"""The lamp in a mirror ball: where it is in one picture, to a fraction of a pixel.

In linear light. What shines in every picture (a window, a lamp in the room) is not the light that moves, and is taken
away. The threshold is half the highlight's own height over what is around it, picture by picture, so that neither
exposure nor the room's darkness matters; beyond white the blob's edges still say where its middle is. Of several blobs
the brightest compact one is the lamp: what table or object throw on the ball is dimmer, or drawn out.
"""

from dataclasses import dataclass
from enum import StrEnum

import cv2
import numpy as np
from numpy.typing import NDArray

from processing.ptm.lights.mirror import Mirror

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

FEWEST_FRAMES = 4
"""From how many pictures on what all of them have in common is taken for the room's light."""
_BLUR_PX = 1.0
_HALF = 0.5
_COMMON_QUANTILE, _OUTSHINES, _NOISE, _MOST_SHARE = 0.9, 4.0, 8.0, 0.05
_LEAST_OF_USUAL = 0.05
_RIM_SHARE = 0.97
_DOUBLE_SHARE = 0.3
_LEAST_FACING = 0.35
_BROAD_DEG = 6.0
_PIXEL_DEVIATION = 1 / np.sqrt(12)


class Flag(StrEnum):
    """What makes a detection doubtful."""

    DOUBLE = "double"
    """A second blob is nearly as strong: another lamp, or a reflection."""
    RIM = "at the rim"
    """The ball mirrors there what is beside or behind it, squeezed: no lamp above the table."""
    BROAD = "broad"
    """The blob spans many degrees: overexposed, out of focus, or no lamp."""


@dataclass(frozen=True)
class Highlight:
    """A lamp's image.

    Attributes
    ----------
    x_px, y_px : its middle in the picture
    spread_px : RMS distance of its light from there
    flags : what is doubtful about it
    """

    x_px: float
    y_px: float
    spread_px: float
    flags: tuple[Flag, ...] = ()


@dataclass(frozen=True)
class _Blob:
    x_px: float
    y_px: float
    spread_px: float
    spread_rad: float
    strength: float


def moving_light(crops: F32) -> F32:
    """Take from pictures (N, H, W) what shines in all of them; fewer than `FEWEST_FRAMES` are left as they are."""
    still = crops.min(axis=0) if len(crops) >= FEWEST_FRAMES else np.zeros_like(crops[0])
    return np.stack([cv2.GaussianBlur(crop - still, (0, 0), _BLUR_PX) for crop in crops])


def stands_out(values: F32) -> bool:
    """Tell whether, of a disc's values (M,), a few outshine all others."""
    peak, common, middle = (float(part) for part in np.quantile(values, [1, _COMMON_QUANTILE, 0.5]))
    noise = 1.4826 * float(np.median(np.abs(values - middle)))
    small = float(np.mean(values > middle + _HALF * (peak - middle))) < _MOST_SHARE
    return small and peak > _OUTSHINES * common and peak > middle + _NOISE * noise


def find_highlights(crops: F32, mirror: Mirror) -> list[Highlight | None]:
    """Find the lamp in every picture of one ball.

    Parameters
    ----------
    crops : (N, H, W) linear light, of any exposure, the ball and what is around it
    mirror : the ball, in the pixels of the crops

    Returns
    -------
    highlights : one a picture; None where the ball lies in shadow
    """
    moving = moving_light(crops)
    rows, columns = np.indices(crops.shape[1:]) + 0.5
    circle = mirror.circle
    disc = np.hypot(columns - circle.x_px, rows - circle.y_px) < _RIM_SHARE * circle.radius_px
    # Neither a firefly nor one bright lamp among many sets the measure for what the others must reach.
    usual = float(np.median([light[disc].max() for light in moving]))
    return [_find_one(np.where(disc, light, 0), disc, mirror, _LEAST_OF_USUAL * usual) for light in moving]


def _find_one(light: F32, disc: NDArray[np.bool_], mirror: Mirror, least: float) -> Highlight | None:
    values = light[disc]
    peak, middle = float(values.max()), float(np.median(values))
    if not (peak >= least and stands_out(values)):
        return None
    threshold = middle + _HALF * (peak - middle)
    count, labels = cv2.connectedComponents((light > threshold).astype(np.uint8), connectivity=8)
    blobs = [_measure(np.where(labels == label, light - threshold, 0), mirror) for label in range(1, count)]
    blobs.sort(key=lambda blob: -blob.strength)
    best = blobs[0]
    flags = []
    if len(blobs) > 1 and blobs[1].strength > _DOUBLE_SHARE * best.strength:
        flags.append(Flag.DOUBLE)
    place = np.array([[best.x_px, best.y_px]])
    if mirror.facing(place)[0] < _LEAST_FACING or mirror.directions(place)[0, 2] <= 0:
        flags.append(Flag.RIM)
    if np.degrees(best.spread_rad) > _BROAD_DEG:
        flags.append(Flag.BROAD)
    return Highlight(best.x_px, best.y_px, best.spread_px, tuple(flags))


def _measure(weights: F32, mirror: Mirror) -> _Blob:
    """Measure a blob: its strength is its light, less where it is drawn out as seen from the ball."""
    rows, columns = np.nonzero(weights)
    light = weights[rows, columns].astype(np.float64)
    share = light / light.sum()
    places = np.stack([columns + 0.5, rows + 0.5], axis=1)
    middle = share @ places
    ways = mirror.directions(places)
    off = ways - share @ ways
    # Three eigenvalues, of which the one along the mean direction is next to nothing.
    spread = np.linalg.eigvalsh((off * share[:, None]).T @ off)[1:]
    pixel_rad2 = (2 * _PIXEL_DEVIATION / mirror.circle.radius_px) ** 2
    roundness = np.sqrt((spread[0] + pixel_rad2) / (spread[1] + pixel_rad2))
    spread_px = float(np.sqrt(share @ np.sum((places - middle) ** 2, axis=1)))
    # What the blur alone would show says nothing about the lamp.
    blur_rad2 = 2 * (2 * _BLUR_PX / mirror.circle.radius_px) ** 2
    spread_rad = float(np.sqrt(max(spread.sum() - blur_rad2, 0)))
    return _Blob(float(middle[0]), float(middle[1]), spread_px, spread_rad, float(light.sum() * roundness))
