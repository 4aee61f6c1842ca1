"""How large blocks should be: a few times the length over which a texture resembles itself."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from processing.ptm.model import Ptm
from processing.ptm.synthesis.orthonormal import check_domain
from processing.ptm.synthesis.settings import LARGEST_BLOCK_PX, SMALLEST_BLOCK_PX, Synthesis
from processing.ptm.synthesis.texture import Textures, emptied, to_textures

F64 = NDArray[np.float64]

_LENGTHS_A_BLOCK = 6.0
_PERIODS_A_BLOCK = 1.25
_SMALLEST_SUGGESTED_PX = 12
_SHARE_OF_SOURCE = 0.25
_PEAK = 0.35
"""From this autocorrelation on a peak counts as a period."""
_PROMINENCE, _AS_HIGH = 0.15, 0.85
"""How far it stands out, and which of several peaks count beside the highest."""


class Suggestion(NamedTuple):
    """What a texture's autocorrelation says.

    Attributes
    ----------
    correlation_px : the lag over which it falls to 1/e, in the mean over all directions
    period_px : the lag of its highest peak beyond that along rows or columns, 0 where there is none
    block_px, overlap_px : what follows
    """

    correlation_px: float
    period_px: int
    block_px: int
    overlap_px: int


def suggest_block(textures: Textures) -> Suggestion:
    """Suggest a block from the autocorrelation of the largest source.

    Six correlation lengths hold a texture's features with their surroundings; where it repeats, a block holds more than
    a period. A block is at most a quarter of the source, or there would be little to choose from.
    """
    planes = max(textures.planes, key=lambda part: part.shape[0] * part.shape[1])[..., : textures.compared]
    correlation = _autocorrelation(planes.astype(np.float64))
    curve = _ring_means(correlation)
    below = np.flatnonzero(curve < np.exp(-1))
    correlation_px = float(below[0]) if len(below) else float(len(curve))
    middle = len(correlation) // 2
    lines = correlation[middle, middle:], correlation[middle:, middle]
    period_px = max(_period(line, int(correlation_px)) for line in lines)
    wanted = max(_LENGTHS_A_BLOCK * correlation_px, _PERIODS_A_BLOCK * period_px)
    least = min(min(part.shape[:2]) for part in textures.planes)
    most = max(SMALLEST_BLOCK_PX, min(LARGEST_BLOCK_PX, int(least * _SHARE_OF_SOURCE)))
    block_px = int(min(max(round(wanted), _SMALLEST_SUGGESTED_PX), most))
    return Suggestion(correlation_px, period_px, block_px, default_overlap(block_px))


def suggest(
    materials: Sequence[Ptm], names: Sequence[str], settings: Synthesis, hole: NDArray[np.bool_] | None = None
) -> Suggestion:
    """Suggest a block for materials; what lies in a hole of the first is no part of it.

    Raises
    ------
    InputError
        As `to_textures`.
    """
    domain = check_domain(materials[0].basis, settings.domain, names[0])
    if hole is not None:
        materials = [emptied(materials[0], hole), *materials[1:]]
    return suggest_block(to_textures(materials, names, domain, settings.chroma))


def default_overlap(block_px: int) -> int:
    """Return a fifth of a block, as 6 of 30 is."""
    return max(1, round(block_px / 5))


def _autocorrelation(planes: F64) -> F64:
    """Return the autocorrelation (2M − 1, 2M − 1) over lags, 0 in the middle; the vectors' products are summed."""
    height, width = planes.shape[:2]
    centred = planes - planes.mean(axis=(0, 1))
    size = [scipy.fft.next_fast_len(2 * side, real=True) for side in (height, width)]
    power = np.square(np.abs(scipy.fft.rfft2(centred, size, axes=(0, 1)))).sum(axis=2)
    sums = scipy.fft.irfft2(power, size)
    most = max(2, min(height, width) // 2)
    lags_y, lags_x = np.mgrid[-most + 1 : most, -most + 1 : most]
    means = sums[lags_y, lags_x] / ((height - np.abs(lags_y)) * (width - np.abs(lags_x)))
    variance = means[most - 1, most - 1]
    # Where all pixels are alike there is nothing that would want a large block.
    return np.asarray(means / variance if variance > 0 else (lags_y == 0) & (lags_x == 0), np.float64)


def _ring_means(correlation: F64) -> F64:
    middle = len(correlation) // 2
    lags = np.arange(-middle, middle + 1)
    ring = np.rint(np.hypot(lags[:, None], lags)).astype(np.int64)
    inside = ring <= middle
    return np.asarray(np.bincount(ring[inside], correlation[inside]) / np.bincount(ring[inside]), np.float64)


def _period(curve: F64, start: int) -> int:
    """Find the lag of the first peak that stands out of what lies before it; 0 if there is none."""
    peaks = np.flatnonzero((curve[1:-1] >= curve[:-2]) & (curve[1:-1] > curve[2:])) + 1
    dips = np.minimum.accumulate(curve)[peaks]
    peaks = peaks[(peaks > start) & (curve[peaks] > _PEAK) & (curve[peaks] - dips > _PROMINENCE)]
    return int(peaks[curve[peaks] > _AS_HIGH * curve[peaks].max()][0]) if len(peaks) else 0
