"""From marks on the sample to the values that they hide: those, near a mark, that disagree with the rest of the turn.

Marks are found wider than flaws are, most of all about the axis, where several meet. A texel on the edge of a cut is
hidden in some slices and not in others; what agrees with the other slices to within the noise is worth keeping, and a
hundredth of a texel's area under something black is worth hiding. So each value is compared with what the others of its
texel say of it (`turn_model`), and marked or released; a mark's middle speaks for all slices.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.kernels import kernel
from processing.amc.flaws.fill import fill
from processing.amc.flaws.sample_frame import track, turn
from processing.amc.flaws.turn_model import MOST_HIDDEN, TurnModel, learn

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST_SLICES = 48
_ROUNDS = 3
# Of the slices in which a place of the sample is marked: what is marked in all of them, and to begin with, and at most.
_SURE, _LIKELY, _POSSIBLE = 0.7, 0.45, 0.25
# Mean squares of a value's deviation in units of its variance.
_ASTRAY, _AGREEING = 4.0, 1.5
_WORST_FIRST, _SWEEPS = 0.4, 16
_DARK = 0.5
_USUAL_QUANTILE, _USUAL = 0.4, 0.6  # of chi-square over its three degrees of freedom


def settle(marks: Mask, middles: Mask, slices: F32, angles_rad: F64, valid: Mask) -> Mask:
    """Find the values that marks on the sample hide.

    Parameters
    ----------
    marks : (S, S) bool, in the frame of the first slice, perhaps too wide
    middles : (S, S) bool, of these what differs most
    slices : (N, S, S, 3) float32, linear light
    angles_rad : (N,)
    valid : (S, S) bool

    Returns
    -------
    hidden : (N, S, S) bool
    """
    if not marks.any():
        return np.zeros(slices.shape[:3], bool)
    every = -(-len(slices) // _MOST_SLICES)
    few, few_rad = slices[::every], angles_rad[::every]
    turns_rad = few_rad - angles_rad[0]
    wide = track(ndimage.binary_dilation(marks), turns_rad) & valid
    model = learn(few, track(marks, turns_rad) & valid, few_rad, valid)
    hidden = _judge(few, _carry(middles, turns_rad), wide, np.zeros_like(wide), model)
    for _ in range(_ROUNDS):
        share = _share(hidden, turns_rad)
        model = learn(few, hidden, few_rad, valid)
        hidden = _among(share, few, turns_rad, wide, model)
    if every > 1:
        share = _share(hidden, turns_rad)
        turns_rad = angles_rad - angles_rad[0]
        wide = track(ndimage.binary_dilation(marks), turns_rad) & valid
        model = learn(slices, _carry(share > _POSSIBLE, turns_rad) & valid, angles_rad, valid)
        hidden = _among(share, slices, turns_rad, wide, model)
    hidden = _release_about_the_axis(hidden, slices, angles_rad, valid, model)
    return hidden & track(_sticking(marks, hidden, angles_rad - angles_rad[0]), angles_rad - angles_rad[0])


def _sticking(marks: Mask, hidden: Mask, turns_rad: F64) -> Mask:
    """Keep the marks that hide some place of the sample in nearly every slice, as flaws do and highlights do not."""
    names, count = ndimage.label(ndimage.binary_dilation(marks, iterations=2), np.ones((3, 3)))
    peaks = ndimage.maximum(_share(hidden, turns_rad), names, np.arange(1, count + 1))
    sticking: Mask = np.isin(names, 1 + np.flatnonzero(np.asarray(peaks) > _SURE))
    return sticking


def _release_about_the_axis(hidden: Mask, slices: F32, angles_rad: F64, valid: Mask, model: TurnModel) -> Mask:
    """Judge anew what is hidden for nearly the whole turn, unless it is dark.

    There nothing turns that could tell a flaw from the material. Beside neighbours as bright, a cut is dark; what is
    bright is the highlight of a lamp beside the camera.
    """
    lost = (hidden.mean(axis=0) > MOST_HIDDEN) & valid
    if not lost.any():
        return hidden
    filled = fill(slices, hidden, angles_rad, valid)
    names, count = ndimage.label(lost, np.ones((3, 3)))
    here = np.arange(1, count + 1)
    seen, expected = (ndimage.sum_labels(light.mean(axis=(0, 3)), names, here) for light in (slices, filled))
    released = hidden & np.isin(names, here[seen > _DARK * expected])
    nothing = np.zeros_like(hidden)
    return (hidden & ~released) | _judge(slices, nothing, released, nothing, model)


def _among(share: F32, slices: F32, turns_rad: F64, wide: Mask, model: TurnModel) -> Mask:
    """Judge the values near places of the sample that were marked in many slices."""
    possible = wide & track(share > _POSSIBLE, turns_rad)
    sure = possible & _carry(share > _SURE, turns_rad)
    return _judge(slices, possible & _carry(share > _LIKELY, turns_rad), possible, sure, model)


def _share(hidden: Mask, turns_rad: F64) -> F32:
    """In which share of the slices each place of the sample is marked; (S, S) in the frame of the first slice."""
    at_rest = [turn(one.astype(np.float32), -float(angle)) for one, angle in zip(hidden, turns_rad, strict=True)]
    return np.asarray(np.mean(at_rest, axis=0), np.float32)


def _carry(marks: Mask, turns_rad: F64) -> Mask:
    """Follow marks through the turn as `track` does, but only to texels whose middle they cover."""
    drawn = marks.astype(np.float32)
    return np.stack([turn(drawn, float(angle)) > np.float32(0.5) for angle in turns_rad])


def _judge(slices: F32, start: Mask, possible: Mask, sure: Mask, model: TurnModel) -> Mask:
    """Mark and release values, of those that are possible and beginning with `start`, until none changes; (N, S, S)."""
    count = len(slices)
    texels = np.flatnonzero(possible.any(axis=0))

    def taken(marks: Mask) -> Mask:
        return np.ascontiguousarray(marks.reshape(count, -1)[:, texels].T)

    hidden = np.zeros((count, start[0].size), bool)
    if len(texels):
        light = np.ascontiguousarray(slices.reshape(count, -1, 3)[:, texels].swapaxes(0, 1))
        some = taken(start & possible)
        ring = model.ring.ravel()[texels]
        _judge_texels(light, some, taken(possible), taken(sure), model.precisions, ring, int(MOST_HIDDEN * count))
        hidden[:, texels] = some.T
    return hidden.reshape(start.shape)


@kernel
def _judge_texels(
    light: F32, hidden: Mask, possible: Mask, sure: Mask, precisions: F64, ring: NDArray[np.intp], most_hidden: int
) -> None:
    """Judge each texel's values (T, N, 3); `hidden` is where to begin and comes back as the answer."""
    for texel in range(len(light)):
        if not possible[texel].any():
            continue
        marks = hidden[texel]
        pulls = precisions[ring[texel]] @ light[texel].astype(np.float64)
        for _ in range(_SWEEPS):
            if marks.sum() > most_hidden:
                break
            deviations = _deviations(pulls, marks, possible[texel], precisions[ring[texel]])
            known = np.sort(deviations[~marks])
            usual = max(1.0, known[int(_USUAL_QUANTILE * len(known))] / _USUAL)
            worst = 0.0
            for place in range(len(marks)):
                if possible[texel, place] and not marks[place]:
                    worst = max(worst, deviations[place])
            limit = max(_ASTRAY * usual, _WORST_FIRST * worst)
            changed = False
            for place in range(len(marks)):
                if marks[place] and not sure[texel, place] and deviations[place] < _AGREEING * usual:
                    marks[place] = False
                    changed = True
                elif possible[texel, place] and not marks[place] and deviations[place] > limit:
                    marks[place] = True
                    changed = True
            if not changed:
                break


@kernel
def _deviations(pulls: F64, marks: Mask, asked: Mask, precision: F64) -> F64:
    """Compare each of a texel's values with what the known others say: mean square in units of its variance; (N,).

    With Q the inverse covariance, x the values and Q x their pulls (N, 3), hiding h moves x_h by δ = −Q_hh⁻¹ (Q x)_h to
    its conditional mean. The known ones then have pulls g = Q x + Q_h δ, the precisions q = Q_ii − Q_ih Q_hh⁻¹ Q_hi,
    and differ from what the others say by g/q; of those that are not asked, q is taken for Q_ii.
    """
    count, channels = pulls.shape
    places = np.flatnonzero(marks)
    deviations = np.zeros(count)
    inside = np.zeros((len(places), len(places)))
    for row in range(len(places)):
        for column in range(len(places)):
            inside[row, column] = precision[places[row], places[column]]
    inverse = np.linalg.inv(inside) if len(places) else inside
    moves = np.zeros((len(places), channels))
    for row in range(len(places)):
        for column in range(len(places)):
            for channel in range(channels):
                moves[row, channel] -= inverse[row, column] * pulls[places[column], channel]
        for channel in range(channels):
            deviations[places[row]] += moves[row, channel] ** 2 / (channels * inverse[row, row])
    for place in range(count):
        if marks[place]:
            continue
        own = precision[place, place]
        if asked[place]:
            for row in range(len(places)):
                part = 0.0
                for column in range(len(places)):
                    part += inverse[row, column] * precision[places[column], place]
                own -= part * precision[place, places[row]]
        for channel in range(channels):
            pull = pulls[place, channel]
            for row in range(len(places)):
                pull += precision[place, places[row]] * moves[row, channel]
            deviations[place] += pull**2 / (channels * own)
    return deviations
