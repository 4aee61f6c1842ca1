"""What moves before the camera, at one instant."""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
Size = tuple[int, int]
"""Height and width of a picture in pixels."""


class LitLamp(NamedTuple):
    """A lamp of a dome that shines: where from, as `Pose` has it, and how brightly, 1 for the arm's at full power."""

    azimuth_deg: float
    elevation_deg: float
    power: float


class Pose(NamedTuple):
    """Where the devices truly are.

    Attributes
    ----------
    turntable_deg : counter-clockwise as the camera sees it
    azimuth_deg, elevation_deg : of the lamp on the arm, in the view frame (x right, y up, z to the camera)
    lamp : 0..1 of full power
    dome : the lamps of a dome that shine
    """

    turntable_deg: float
    azimuth_deg: float
    elevation_deg: float
    lamp: float
    dome: tuple[LitLamp, ...] = ()

    @classmethod
    def from_json(cls, values: Sequence[Any]) -> Self:
        """Return a pose that came over the side channel."""
        turntable_deg, azimuth_deg, elevation_deg, lamp, *rest = values
        dome = tuple(LitLamp(*values) for lamps in rest for values in lamps)
        return cls(turntable_deg, azimuth_deg, elevation_deg, lamp, dome)


class PlannedPose(NamedTuple):
    """Where a plan will send the devices; what it leaves out stays where it is.

    Attributes
    ----------
    turntable_deg : as RIG.toml's turntable counts
    azimuth_deg, elevation_deg : as RIG.toml's arm counts
    lamp : 0..1 of full power
    """

    turntable_deg: float | None = None
    azimuth_deg: float | None = None
    elevation_deg: float | None = None
    lamp: float = 1.0


class Scene(Protocol):
    """What stands before the camera."""

    def is_ready(self, pose: Pose, size: Size) -> bool:
        """Tell whether `light` of this pose alone would be exact now; if not, see to it that it will be."""

    def light(self, poses: Sequence[Pose], size: Size) -> F32:
        """Return the light that falls on the sensor during an exposure.

        Parameters
        ----------
        poses : where the devices are at instants that are evenly spread over the exposure; one if nothing moves, and
            only then is the picture exact rather than quick
        size : height and width of the picture

        Returns
        -------
        linear : (H, W, 3) float32, linear RGB; 1 fills a pixel in 10 ms without gain
        """
