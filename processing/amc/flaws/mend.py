"""What is wrong with the sample or the camera, found or marked, and made good in the slices."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.flaws.defects import find_defects
from processing.amc.flaws.fill import fill_in_place
from processing.amc.flaws.settle import settle
from processing.amc.flaws.weave import average_weave
from processing.amc.noise import noise_variance
from processing.amc.settings import Settings
from processing.amc.shots import Shots, Slices

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST_FILLED = 0.5
_MOST_TEXELS = 4096
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
    """

    turning: Mask
    still: Mask
    filled: float


def mend(slices: Slices, shots: Shots, settings: Settings, marks: Mask | None) -> Flaws:
    """Find and fill in place.

    Parameters
    ----------
    marks : (N, S, S) bool, what somebody marked, followed through the slices
    """
    angles_rad, valid = shots.series.angles_rad, slices.valid
    marked, still = np.zeros(slices.light.shape[:3], bool), np.zeros_like(valid)
    if settings.defects == "find" and _changes(slices, noise_variance(slices.light, valid, slices.difference_gain)):
        slices.room.release()
        found = find_defects(slices.light, angles_rad, valid, slices.room.release)
        marked, still = settle(found.turning, found.middles, slices.light, angles_rad, valid), found.still
    if marks is not None:
        marked |= marks
    turning = marked[shots.first] & valid
    marked |= still
    marked &= valid
    filled = _fill(slices, marked, shots) if marked.any() else 0.0
    slices.room.release()
    if settings.weave == "average":
        slices.light[:] = average_weave(slices.light, angles_rad, valid)
    return Flaws(turning, still & valid, filled)


def _fill(slices: Slices, marked: Mask, shots: Shots) -> float:
    """Fill marks (N, S, S) in place; return which share of all values they are."""
    share = float(marked.sum() / (slices.valid.sum() * len(marked)))
    if share > _MOST_FILLED:
        raise InputError(
            f"{shots.stack.paths[0].parent}: marks cover {share:.0%} of the sphere, which leaves too little to fill "
            "from; a mask is white where there is NO material; give one that is smaller, or a better sample"
        )
    fill_in_place(slices.light, marked, shots.series.angles_rad, slices.valid)
    return share


def _changes(slices: Slices, noise: float) -> bool:
    """Tell whether anything changes over the turn; where nothing does, nothing sticks to the sample either."""
    texels = np.flatnonzero(slices.valid)
    light = slices.light.reshape(len(slices.light), -1, 3)[:, texels[:: -(-len(texels) // _MOST_TEXELS)]]
    change = float(np.mean(light.var(axis=0)))
    return change > _LEAST_CHANGE * max(noise, 1e-12)
