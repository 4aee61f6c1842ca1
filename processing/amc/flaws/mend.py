"""What is wrong with the sample or the camera, found or marked, and made good in the slices."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.flaws.defects import find_defects
from processing.amc.flaws.fill import fill
from processing.amc.flaws.sample_frame import track, turn_mask
from processing.amc.flaws.tighten import tighten
from processing.amc.flaws.weave import average_weave
from processing.amc.noise import noise_variance
from processing.amc.settings import Settings
from processing.amc.shots import Shots, Slices

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST_FILLED = 0.5
_LEAST_CHANGE = 1.5
"""Variance over the turn in units of the noise's."""


@dataclass(frozen=True)
class Flaws:
    """Marks on the disc.

    Attributes
    ----------
    turning : (S, S) bool, folds and cuts, which turn with the sample; as the picture that was shot first shows them
    still : (S, S) bool, dead and hot pixels, which stay where they are
    filled : share of the disc's values that were replaced, 0..1
    weakest : how sure the weakest of what was found is, 1 being the alarm; infinite when nothing was found
    """

    turning: Mask
    still: Mask
    filled: float
    weakest: float


def mend(slices: Slices, shots: Shots, settings: Settings, marks: Mask | None) -> Flaws:
    """Find and fill in place.

    Parameters
    ----------
    marks : (N, S, S) bool, what somebody marked, followed through the slices
    """
    angles_rad, valid = shots.series.angles_rad, slices.valid
    to_first_rad = float(angles_rad[shots.first] - angles_rad[0])
    turning, still, weakest = np.zeros_like(valid), np.zeros_like(valid), float("inf")
    if settings.defects == "find":
        noise = noise_variance(slices.light, valid, slices.difference_gain)
        if _changes(slices, noise):
            found = find_defects(slices.light, angles_rad, valid)
            turning = tighten(found.turning, slices.light, angles_rad, valid, noise)
            still, weakest = found.still, found.weakest
    filled = 0.0
    if turning.any() or still.any() or marks is not None:
        marked = track(turning, angles_rad - angles_rad[0])
        marked |= still if marks is None else marks | still
        marked &= valid
        filled = _fill(slices, marked, shots)
    if settings.weave == "average":
        slices.light[:] = average_weave(slices.light, angles_rad, valid)
    at_first = turn_mask(turning, to_first_rad) if turning.any() else turning
    if marks is not None:
        at_first = at_first | marks[shots.first]
    return Flaws(at_first & valid, still & valid, filled, weakest)


def _fill(slices: Slices, marked: Mask, shots: Shots) -> float:
    """Fill marks (N, S, S) in place; return which share of all values they are."""
    share = float(marked.sum() / (slices.valid.sum() * len(marked)))
    if share > _MOST_FILLED:
        raise InputError(
            f"{shots.stack.paths[0].parent}: marks cover {share:.0%} of the sphere, which leaves too little to fill "
            "from; a mask is white where there is NO material; give one that is smaller, or a better sample"
        )
    slices.light[:] = fill(slices.light, marked, shots.series.angles_rad, slices.valid)
    return share


def _changes(slices: Slices, noise: float) -> bool:
    """Tell whether anything changes over the turn; where nothing does, nothing sticks to the sample either."""
    light = slices.light[:, slices.valid]
    change = float(np.mean(light.var(axis=0)))
    return change > _LEAST_CHANGE * max(noise, 1e-12)
