"""What is wrong with the sample or the camera, found or marked, and made good in the slices."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from processing.amc.flaws.defects import Defects, find_defects
from processing.amc.flaws.fill import fill
from processing.amc.flaws.sample_frame import track, turn_mask
from processing.amc.flaws.tighten import tighten
from processing.amc.flaws.weave import average_weave
from processing.amc.settings import Settings
from processing.amc.shots import Shots, Slices

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]


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
    none = np.zeros_like(valid)
    found = Defects(none, none, np.zeros(valid.shape, np.float32), 0.0, float("inf"))
    if settings.defects == "find":
        found = find_defects(slices.light, angles_rad, valid)
        found = replace(found, turning=tighten(found.turning, slices.light, angles_rad, valid))
    turning = none if marks is None else marks[shots.first]
    if found.turning.any():
        turning = turning | turn_mask(found.turning, to_first_rad)
    filled = 0.0
    if turning.any() or found.still.any():
        marked = track(found.turning, angles_rad - angles_rad[0])
        marked |= found.still if marks is None else marks | found.still
        marked &= valid
        filled = float(marked.sum() / (valid.sum() * len(angles_rad)))
        slices.light[:] = fill(slices.light, marked, angles_rad, valid)
    if settings.weave == "average":
        slices.light[:] = average_weave(slices.light, angles_rad, valid)
    return Flaws(turning & valid, found.still & valid, filled, found.weakest)
