"""How the display values of frames are spread."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import U8

F64 = NDArray[np.float64]

BINS = 64


@dataclass(frozen=True)
class Tones:
    """Histograms of thumbnails.

    Attributes
    ----------
    steps : (N,) whose
    histograms : (N, BINS) counts of the mean of R, G and B, from 0 to 1
    """

    steps: tuple[int, ...]
    histograms: F64

    def quantile(self, share: float) -> F64:
        """Return the display value (N,) below which that share of each picture lies."""
        summed = np.cumsum(self.histograms, axis=1)
        wanted = share * summed[:, -1]
        centres = (np.arange(BINS) + 0.5) / BINS
        return np.array([np.interp(at, row, centres) for at, row in zip(wanted, summed, strict=True)], np.float64)


def tones_of(pictures: Iterable[tuple[int, U8 | None]]) -> Tones:
    """Count the pictures of steps; those that cannot be read are left out."""
    counted = [(step, _histogram(picture)) for step, picture in pictures if picture is not None]
    rows = np.array([row for _, row in counted], np.float64).reshape(-1, BINS)
    return Tones(tuple(step for step, _ in counted), rows)


def _histogram(picture: U8) -> F64:
    grey = picture.mean(axis=-1, dtype=np.float32) / 256
    return np.histogram(grey, BINS, (0, 1))[0].astype(np.float64)
