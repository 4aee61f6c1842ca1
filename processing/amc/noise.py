"""How noisy slices are, told from the slices themselves.

A material changes smoothly from texel to texel and from slice to slice; noise does not. What three second differences
leave, across columns, rows and slices, is noise, except where a sharp highlight sweeps past. So each texel is judged by
its median over the slices.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from processing.amc.resample import Resampler

F32 = NDArray[np.float32]

_SECOND_DIFFERENCE = np.array([1, -2, 1], np.float32)
_SLICE_GAIN = 6.0
"""The sum of its squares."""
_MEDIAN_OF_SQUARE = 0.4549364
"""Median of a squared normal deviate of variance 1."""
_MOST_SLICES, _MOST_TEXELS = 96, 4096


def noise_variance(slices: F32, valid: NDArray[np.bool_], gain: float = 36.0) -> float:
    """Estimate the mean variance of the noise in a texel's channel, in linear light squared.

    Parameters
    ----------
    slices : (N, S, S, 3) in the order of their angles, which go round
    valid : (S, S) bool
    gain : variance of the spatial differences for noise of variance 1, as `difference_gain` measures it
    """
    used = min(len(slices), _MOST_SLICES)
    texels = np.flatnonzero(_inner(valid))
    if not len(texels):
        return 0.0
    texels = texels[:: -(-len(texels) // _MOST_TEXELS)]
    flat = np.stack([_spatial(one).reshape(-1, 3)[texels] for one in slices[:used]])
    if used == len(slices):
        flat = np.concatenate([flat[-1:], flat, flat[:1]])
    left = flat[2:] - 2 * flat[1:-1] + flat[:-2]
    squares = np.sort(left**2, axis=0)  # several times as fast as np.median, which says the same
    median = (squares[(len(squares) - 1) // 2] + squares[len(squares) // 2]) / 2
    return float(median.mean() / (_MEDIAN_OF_SQUARE * _SLICE_GAIN * gain))


def difference_gain(resampler: Resampler, shape: tuple[int, int]) -> float:
    """Measure what resampling and differences make of white noise in pictures (H, W), by the variance it leaves.

    Neighbouring texels share pixels, so that their noise is alike and differs less.
    """
    noise = np.random.default_rng(0).random((*shape, 3), np.float32) - np.float32(0.5)
    slice_of_noise = resampler(noise)
    inner = _inner(resampler.valid)
    if not inner.any():
        return _SLICE_GAIN**2
    return float(np.var(_spatial(slice_of_noise)[inner]) / np.var(slice_of_noise[resampler.valid]))


def _spatial(one: F32) -> F32:
    """Second differences across columns and rows; (S − 2, S − 2, 3)."""
    both = cv2.sepFilter2D(one, -1, _SECOND_DIFFERENCE, _SECOND_DIFFERENCE)[1:-1, 1:-1]
    return np.asarray(both, np.float32)


def _inner(valid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Texels, without the outermost ones of the table, whose eight neighbours are all valid."""
    size = valid.shape[0] - 2
    around = [valid[row : row + size, column : column + size] for row in range(3) for column in range(3)]
    inner: NDArray[np.bool_] = np.logical_and.reduce(around)
    return inner
