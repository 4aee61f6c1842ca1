"""Finding folds, cuts and hot pixels: what turns rigidly with the sample, and what does not turn at all.

A cut stays in its place on the sample and disagrees there with its neighbours over the whole turn, in level (dark,
bright) or in phase (a fold, whose tangent points elsewhere). A hot pixel stays in its place in the picture. A highlight
does neither. The AMC paper has marks set by hand (section 5.1); these are candidates for the same use.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.flaws.light_curves import (
    LEVELS,
    first_weights,
    light_curves,
    local_fit,
    rms_of_groups,
    strays_from_neighbours,
    usual_stray,
)
from processing.amc.flaws.still_marks import find_still
from processing.amc.geometry import texel_plane

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Relative to the neighbours; below a few times this nothing is a defect, however even the sample.
_LEAST_LEVEL, _LEAST_WAVE = 0.008, 0.003
_COARSE, _FINE, _FINEST_PX = 1 / 8, 1 / 24, 2.5
_COARSE_KNEES, _FINE_KNEES = (4.0, 3.0, 2.2, 1.8, 1.6), (2.5, 2.0, 1.8)
_GROWTHS, _GROWTH_PX = 3, 2
_ALARMS_OF_GROWTH = (5.0, 4.0)
_DIRECTIONS = 8
_LINE_SHARE, _SHORTEST_LINE_PX = 0.1, 5
_MOST_STRAY, _LEAST_COVERED, _LEAST_USUAL = 8.0, 0.3, 0.15
# Alarms of the coarse and the fine comparison, in levels and in waves, calibrated on clean samples.
_ALARMS = ((4.2, 3.3), (3.5, 3.5))
_GROWN_TO, _GROWN_TO_PEAK, _PEAK_WINDOW_PX = 0.55, 0.35, 7
_LEAST_CORE_PX = 3
_MIDDLE, _WORST_WITHIN = 0.4, 0.35
_RIM, _RIM_RING = 0.8, 0.04
_USUAL_OF_MEDIAN = 1.4826
_MOST_ASKED = 2048


@dataclass(frozen=True)
class Defects:
    """What is wrong with a sample and its pictures.

    Attributes
    ----------
    turning : (S, S) bool, folds and cuts, in the frame of slice 0; rather too wide than too narrow
    middles : (S, S) bool, of these the places that differ most
    still : (S, S) bool, texels that hold a hot or dead pixel, or a speck on the lens, in every slice
    """

    turning: Mask
    middles: Mask
    still: Mask


def find_defects(slices: F32, angles_rad: F64, valid: Mask, release: Callable[[], None] = lambda: None) -> Defects:
    """Find what disagrees with its neighbours, turning or still.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light; [s, row, column] with row 0 at n_y = +1
    angles_rad : (N,) turntable angle of each slice
    valid : (S, S) bool, the disc that was seen
    release : called where slices have been looked at, to give back what they took of memory
    """
    still = find_still(slices, valid)
    release()
    curves = light_curves(slices, angles_rad - angles_rad[0], valid, still, release)
    turning = _grown(_strength(curves, valid), valid)
    return Defects(turning, _middles(turning, curves, valid), still)


def _strength(curves: F32, valid: Mask) -> F32:
    """Compare over wide neighbourhoods, which see darts, then over narrow ones, which see thin folds, then grow."""
    size = len(valid)
    weights = first_weights(curves, valid)
    level = weights > 0
    strength = np.zeros(valid.shape, np.float32)
    passes = ((_COARSE * size, _COARSE_KNEES), (max(_FINE * size, _FINEST_PX), _FINE_KNEES))
    for (sigma, knees), alarms in zip(passes, _ALARMS, strict=True):
        strays, weights = strays_from_neighbours(curves, weights, valid, sigma, knees, _floor(curves))
        _raise_to(strength, strays, valid, level, alarms)
    for _ in range(_GROWTHS):
        near = ndimage.binary_dilation(_grown(strength, valid), iterations=_GROWTH_PX) & valid
        if near.any():
            _grow(strength, curves, near, level, valid)
    return strength


def _grow(strength: F32, curves: F32, near: Mask, level: Mask, valid: Mask) -> None:
    """Compare what is near a mark with what is not: the inside of a dart agrees with itself, but not with that."""
    strays = _against_the_rest(near, curves, valid)
    afresh = np.zeros_like(strength)
    _raise_to(afresh, strays, valid, level, _ALARMS_OF_GROWTH)
    strength[near] = np.maximum(strength, afresh)[near]


def _against_the_rest(near: Mask, curves: F32, valid: Mask) -> F32:
    """Compare all places with those that are not near a mark; (K, S, S) in units of what is usual."""
    believed = valid & ~near
    strays = curves - local_fit(curves, believed.astype(np.float32), _COARSE * len(valid))
    strays /= usual_stray(strays, believed, _floor(curves))
    return strays


def _middles(turning: Mask, curves: F32, valid: Mask) -> Mask:
    """Find what differs nearly as much as the worst place around it, without the lines that widen marks."""
    if not turning.any():
        return turning
    near = ndimage.binary_dilation(turning, iterations=_GROWTH_PX) & valid
    differing = np.where(turning, np.maximum(*rms_of_groups(_against_the_rest(near, curves, valid))), 0)
    window = max(_SHORTEST_LINE_PX, int(_WORST_WITHIN * len(valid)) | 1)
    middles: Mask = turning & (differing > _MIDDLE * ndimage.maximum_filter(differing, window))
    return middles


def _raise_to(strength: F32, strays: F32, valid: Mask, believed: Mask, alarms: tuple[float, float]) -> None:
    for found, alarm in zip(_along_lines(strays, valid, believed), alarms, strict=True):
        np.maximum(strength, found / alarm, out=strength)


def _floor(curves: F32) -> F32:
    floor = np.full(len(curves), _LEAST_WAVE, np.float32)
    floor[:LEVELS] = _LEAST_LEVEL
    return floor


def _along_lines(strays: F32, valid: Mask, believed: Mask) -> tuple[F32, F32]:
    """Average along short lines, for each place the direction that strays most: cuts are long, noise and threads not.

    Returns
    -------
    levels, waves : (S, S) float32, in units of what averages of that length usually are
    """
    length = max(_SHORTEST_LINE_PX, int(_LINE_SHARE * len(valid)) | 1)
    limited = np.clip(strays, -_MOST_STRAY, _MOST_STRAY) * valid
    asked = np.flatnonzero(believed)
    asked = asked[:: -(-len(asked) // _MOST_ASKED)]
    best = [np.zeros(valid.shape, np.float32) for _ in range(2)]
    for direction in range(_DIRECTIONS):
        kernel = _line(length, direction * np.pi / _DIRECTIONS)
        covered = cv2.filter2D(valid.astype(np.float32), -1, kernel, borderType=cv2.BORDER_CONSTANT)
        sums = np.stack([cv2.filter2D(one, -1, kernel, borderType=cv2.BORDER_CONSTANT) for one in limited])
        along = np.asarray(sums / np.sqrt(np.maximum(covered, _LEAST_COVERED)), np.float32)
        some = np.abs(along.reshape(len(along), -1)[:, asked])
        usual = np.maximum(_USUAL_OF_MEDIAN * np.median(some, axis=1), _LEAST_USUAL)
        along /= usual.astype(np.float32)[:, None, None]
        for joined, most in zip(rms_of_groups(along), best, strict=True):
            np.maximum(most, joined * valid, out=most)
    return _beyond_surroundings(best[0], believed), _beyond_surroundings(best[1], believed)


def _beyond_surroundings(along: F32, believed: Mask) -> F32:
    """Divide by what is usual around: where all is astray (beside a highlight, along the rim), nothing is."""
    around = usual_stray(along[None], believed, np.full(1, _USUAL_OF_MEDIAN, np.float32))[0]
    radius = np.hypot(*texel_plane(len(believed)))
    for inner in np.arange(_RIM, 1, _RIM_RING):
        ring = (radius >= inner) & (radius < inner + _RIM_RING)
        if (ring & believed).any():
            around[ring] = np.maximum(around[ring], _USUAL_OF_MEDIAN * np.median(along[ring & believed]))
    return np.asarray(_USUAL_OF_MEDIAN * along / around, np.float32)


def _line(length: int, angle_rad: float) -> F32:
    """Draw a line of this many texels through the middle of a kernel, with linear weights that sum to 1."""
    reach = length // 2
    kernel = np.zeros((length + 2, length + 2), np.float32)
    for step in np.linspace(-reach, reach, 8 * length):
        column, row = reach + 1 + step * np.cos(angle_rad), reach + 1 + step * np.sin(angle_rad)
        left, top = int(np.floor(column)), int(np.floor(row))
        across, down = column - left, row - top
        corners = np.outer([1 - down, down], [1 - across, across])
        kernel[top : top + 2, left : left + 2] += corners[: length + 2 - top, : length + 2 - left]
    return np.asarray(kernel / kernel.sum(), np.float32)


def _grown(strength: F32, valid: Mask) -> Mask:
    """Keep what touches a place beyond the alarm; take in the texel around it, which the mark touches too."""
    # A line that crosses a strong cut at an angle strays beside it too.
    peak = ndimage.maximum_filter(strength, _PEAK_WINDOW_PX)
    names, count = ndimage.label(strength > np.maximum(_GROWN_TO, _GROWN_TO_PEAK * peak), np.ones((3, 3)))
    cores = ndimage.sum_labels(strength > 1, names, np.arange(1, count + 1))
    kept = np.isin(names, 1 + np.flatnonzero(cores >= _LEAST_CORE_PX))
    grown: Mask = ndimage.binary_dilation(kept) & valid
    return grown
