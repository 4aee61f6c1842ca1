"""Letting go of what was marked without need.

Marks are found wider than flaws are, most of all about the axis, where several meet. Filled from the rest of the turn,
a flaw differs from what was seen there; what was marked beside it does not, or by little.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.flaws.fill import fill
from processing.amc.flaws.sample_frame import track, turn

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST_SLICES = 48
_NOISES = 16.0
_LEVEL_SHARE = 0.02
# A large hole is filled badly: what differs far less than the flaw beside it is not one. Once the holes are small, less
# counts as well. First so many texels around are kept.
_PASSES = ((0.15, 2), (0.03, 0))
_PEAK_WINDOW = 0.2


def tighten(marks: Mask, slices: F32, angles_rad: F64, valid: Mask, noise: float) -> Mask:
    """Keep of marks what disagrees with the rest of the turn.

    Parameters
    ----------
    marks : (S, S) bool, in the frame of the first slice
    slices : (N, S, S, 3) float32, linear light
    angles_rad : (N,)
    valid : (S, S) bool
    noise : variance of a texel's noise, as `noise_variance` has it

    Returns
    -------
    marks : (S, S) bool, some of those that came in
    """
    step = -(-len(slices) // _MOST_SLICES)
    light, angles_rad = slices[::step], angles_rad[::step]
    turns_rad = angles_rad - angles_rad[0]
    least = _NOISES * noise + _LEVEL_SHARE**2 * _mean_square(light, turns_rad)
    for peak_share, around in _PASSES:
        if not marks.any():
            break
        filled = fill(light, track(marks, turns_rad) & valid, angles_rad, valid)
        apart = _mean_square((light - filled).astype(np.float32), turns_rad)
        peak = ndimage.maximum_filter(np.where(marks, apart, 0), int(_PEAK_WINDOW * len(valid)) | 1)
        kept = marks & (apart > np.maximum(least, peak_share * peak))
        marks = marks & ndimage.binary_dilation(kept, iterations=around) if around else kept
    return marks


def _mean_square(light: F32, turns_rad: F64) -> F32:
    """Average over the turn in the sample's frame, (S, S)."""
    squares = (turn(np.mean(one**2, axis=-1), -float(angle)) for one, angle in zip(light, turns_rad, strict=True))
    total: F32 = np.sum(np.stack(list(squares)), axis=0) / np.float32(len(light))
    return total
