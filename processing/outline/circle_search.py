"""Where in the pictures a large circle might be: a Hough transform by FFT over gradients that point along a radius.

Two pictures are searched, each by itself: the mean over the turn (where what stays has its edges) and the deviation
from it (which is dark wherever nothing turns, whatever the background shows). Weak edges count nearly as much as strong
ones, for a rim may be dark.
"""

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft, special

from litrig.base.radiometry import encode_srgb

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
C64 = NDArray[np.complex64]

_LONGEST_SIDE_PX = 160
_SMALLEST_SHARE, _LARGEST_SHARE = 0.1, 0.6
# Rings that reach further past a border come in again at the other.
_BEYOND_BORDER = 0.3
_BESSEL_STEP = 0.02
_STEP = 1.025
_RING_WIDTH_PX = 0.9
_MOST_CANDIDATES = 3
# Of the mean picture: brighter pixels may be clipped for the search.
_WHITE_QUANTILE = 0.98
# Gradients of Scharr's operator below a code of eight bits a pixel say nothing.
_CODE_GRADIENT = 32 / 255


def candidates(greys: F32) -> list[tuple[float, float, float]]:
    """Propose circles (x, y, radius in pixels of `greys`), up to three from each picture.

    Parameters
    ----------
    greys : (N, H, W) linear light at several turntable angles, of any exposure
    """
    shrink = min(1.0, _LONGEST_SIDE_PX / max(greys.shape[1:]))
    codes = encode_srgb(greys / max(float(np.quantile(greys.mean(axis=0), _WHITE_QUANTILE)), 1e-12))
    shorter_side = round(shrink * min(greys.shape[1:]))
    radii = ring_radii(_SMALLEST_SHARE * shorter_side, _LARGEST_SHARE * shorter_side)
    return [
        circle
        for picture in (codes.mean(axis=0), codes.std(axis=0))
        for circle in find_rings(picture, shrink, radii, _MOST_CANDIDATES)
    ]


def find_rings(picture: F32, shrink: float, radii: F64, most: int) -> list[tuple[float, float, float]]:
    """Propose the likeliest circles (x, y, radius in its pixels) of one picture (H, W) of display-like values.

    Parameters
    ----------
    shrink : by which factor the picture is shrunk before it is searched, at most 1
    radii : the radii to try, in pixels of the shrunk picture
    most : how many circles
    """
    small = _shrunk(picture, shrink)
    scale_y, scale_x = (full / short for full, short in zip(picture.shape, small.shape, strict=True))
    return [
        ((column + 0.5) * scale_x, (row + 0.5) * scale_y, radius * (scale_x + scale_y) / 2)
        for radius, row, column in _circles(small, radii, most)
    ]


def ring_radii(smallest_px: float, largest_px: float) -> F64:
    """Return radii between two, in steps of a soft ring's width."""
    count = int(np.log(largest_px / smallest_px) / np.log(_STEP)) + 1
    radii: F64 = smallest_px * np.power(_STEP, np.arange(count))
    return radii


def _circles(picture: F32, radii: F64, most: int) -> Iterator[tuple[float, int, int]]:
    """Convolve the field with rings of all radii, in frequency, where a ring with two turns is a Bessel function.

    ∫ δ(|x| − r) cos 2φ exp(−i k·x) dx ∝ −J₂(|k| r) cos 2φ_k, the same with sin; a Gaussian damps it to a soft ring.
    """
    height, width = picture.shape
    padded = tuple(
        fft.next_fast_len(side + int(_BEYOND_BORDER * min(picture.shape)), real=True) for side in picture.shape
    )
    frequency_y, frequency_x = 2 * np.pi * fft.fftfreq(padded[0])[:, None], 2 * np.pi * fft.rfftfreq(padded[1])
    frequency = np.hypot(frequency_x, frequency_y)
    cosine, sine = (frequency_x**2 - frequency_y**2), 2 * frequency_x * frequency_y
    across, askew = (fft.rfft2(part, padded) for part in _radial_field(picture))
    soft = np.exp(-0.5 * (frequency * _RING_WIDTH_PX) ** 2) / np.maximum(frequency**2, 1e-12)
    field = (-(across * cosine + askew * sine) * soft).astype(np.complex64)
    fine = np.arange(0, float(frequency.max()) * radii[-1] + 2 * _BESSEL_STEP, _BESSEL_STEP)
    bessel = special.jv(2, fine).astype(np.float32)
    scores = np.stack(
        [_score(field, frequency / _BESSEL_STEP, bessel, float(radius), padded)[:height, :width] for radius in radii]
    )
    return _peaks(scores, radii, most)


def _score(field: C64, places: F64, bessel: F32, radius: float, padded: tuple[int, ...]) -> F32:
    """Mean over each circle of this radius of how radial the gradients are, times √radius for the many that agree."""
    ring = bessel[np.rint(places * radius).astype(np.int32)]
    score: F32 = fft.irfft2(field * ring, padded) * np.float32(np.sqrt(radius))
    return score


def _shrunk(picture: F32, shrink: float) -> F32:
    small = cv2.resize(picture, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA)
    return cv2.GaussianBlur(small, (0, 0), 0.8).astype(np.float32)


def _radial_field(picture: F32) -> tuple[F32, F32]:
    """Gradients as double angles (cos 2φ, sin 2φ), so that dark-to-bright and bright-to-dark agree; length below 1."""
    along_x = cv2.Scharr(picture, cv2.CV_32F, 1, 0)
    along_y = cv2.Scharr(picture, cv2.CV_32F, 0, 1)
    energy = along_x**2 + along_y**2
    soft = energy + np.quantile(energy, 0.85) + _CODE_GRADIENT**2
    return ((along_x**2 - along_y**2) / soft).astype(np.float32), (2 * along_x * along_y / soft).astype(np.float32)


def _peaks(scores: F32, radii: F64, most: int) -> Iterator[tuple[float, int, int]]:
    """Yield (radius, row, column) of the best circles, each unlike those before."""
    left = scores.copy()
    rows, columns = np.mgrid[: scores.shape[1], : scores.shape[2]]
    for _ in range(most):
        level, row, column = (int(place) for place in np.unravel_index(int(np.argmax(left)), left.shape))
        yield float(radii[level]), row, column
        alike = np.abs(np.log(radii / radii[level])) < 0.1
        near = np.hypot(rows - row, columns - column) < 0.1 * radii[level]
        left[np.ix_(alike, near.any(1), near.any(0))] = -np.inf
