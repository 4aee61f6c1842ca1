"""Which parts of a pose change what a scene shows.

What does not matter is set to one value, so that poses of equal pictures are equal: the arm may move while the camera
looks at a sphere under fixed lights, and the sphere is at rest all the same.
"""

from typing import NamedTuple

from firmware_sim.scene.pose import Pose

DECIMALS = 3
"""A servo's tick is 88 thousandths of a degree, a step of the arm 10, a step of the lamp 4 thousandths of its power."""


class Relevance(NamedTuple):
    """What the picture depends on.

    Attributes
    ----------
    turntable : the sample turns with it
    arm : the lamp on the arm lights the sample
    """

    turntable: bool
    arm: bool

    def of(self, pose: Pose) -> Pose:
        """Return the pose without what does not matter; a scene with lights of its own sees a lamp of power 1."""
        turntable_deg = pose.turntable_deg if self.turntable else 0.0
        return pose._replace(turntable_deg=turntable_deg) if self.arm else Pose(turntable_deg, 0.0, 0.0, 1.0)


def standard(pose: Pose) -> Pose:
    """Return the pose that stands for all that look the same: angles and power rounded, within one turn.

    Nobody sees where a dark lamp is. Its power is no mere factor: what is behind the sample may have its own light.
    """
    # Turns are taken off before, which leaves the digits of a difference, and after, for 359.9999° rounds to 360°.
    turntable_deg, azimuth_deg = (round(angle_deg % 360, DECIMALS) % 360 for angle_deg in pose[:2])
    lamp = round(pose.lamp, DECIMALS)
    if not lamp:
        return Pose(turntable_deg, 0.0, 0.0, 0.0)
    return Pose(turntable_deg, azimuth_deg, round(pose.elevation_deg, DECIMALS) + 0.0, lamp)
