"""How well a polynomial texture map gives back the pictures that it was fitted to."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.progress import Progress, Report, silent
from processing.ptm.model import Ptm
from processing.ptm.relight import relight
from processing.stack import Stack


@dataclass(frozen=True)
class FitQuality:
    """Peak signal-to-noise ratios against white, in dB; infinite for no error at all.

    Attributes
    ----------
    psnr_db : over all frames
    per_light_db : (N,) frame by frame
    residuals : (H, W) float32, RMS error of each pixel over frames and channels
    """

    psnr_db: float
    per_light_db: NDArray[np.float64]
    residuals: NDArray[np.float32]

    def worst(self, count: int) -> list[int]:
        """Return the indices of the frames that fit worst, the worst first."""
        return [int(index) for index in np.argsort(self.per_light_db, kind="stable")[:count]]


def fit_quality(ptm: Ptm, stack: Stack, light_dirs: NDArray[np.floating], report: Report = silent) -> FitQuality:
    """Relight at the light of every frame and compare; values are cut to 0..1 first, as a display shows them.

    Parameters
    ----------
    stack : N pictures
    light_dirs : (N, 3), as for the fit
    """
    errors = np.zeros(len(stack))
    squares = np.zeros(stack.shape, np.float32)
    for index in range(len(stack)):
        shown = np.clip(relight(ptm, light_dirs[index]), 0, 1)
        squared = np.mean((shown - stack.frame(index, ptm.space)) ** 2, axis=-1)
        errors[index] = np.mean(squared, dtype=np.float64)
        squares += squared
        report(Progress("comparing", index + 1, len(stack), stack.paths[index].name))
    return FitQuality(float(_psnr_db(errors.mean())), _psnr_db(errors), np.sqrt(squares / len(stack)))


def _psnr_db(squared_error: NDArray[np.float64]) -> NDArray[np.float64]:
    with np.errstate(divide="ignore"):
        decibels: NDArray[np.float64] = -10 * np.log10(squared_error)
    return decibels
