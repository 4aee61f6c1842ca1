"""From directions of light to joint angles and back, for an arm that turns about the sample.

The arm's own frame has its azimuth axis as z, through the sample's middle, and z = 0 in the sample's plane. The
elevation joint may sit above or below that plane: then the lamp's direction from the sample is not the joint's angle.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from litrig.base.directions import F64, angles_from_direction, direction_from_angles
from rig.config import ArmConfig

ZENITH_DEG = 89.999
"""From here on every azimuth is the same."""


class Joints(NamedTuple):
    """Angles of the two joints, in degrees; more than a turn apart they are different places of the cables."""

    azimuth_deg: float
    elevation_deg: float


@dataclass(frozen=True)
class ArmGeometry:
    """Where the lamp is for given joints.

    Attributes
    ----------
    view_from_arm : (3, 3) rotation of the arm's axes into the view frame
    radius_mm : from the elevation joint to the lamp; None means so far away that the joint's height does not matter
    pivot_height_mm : of the elevation joint above the sample's plane
    """

    view_from_arm: F64
    radius_mm: float | None = None
    pivot_height_mm: float = 0.0

    @classmethod
    def of(cls, config: ArmConfig) -> "ArmGeometry":
        """Take it from RIG.toml."""
        return cls(np.array(config.view_from_arm), config.radius_mm, config.pivot_height_mm)

    def direction(self, joints: Joints) -> F64:
        """Return the unit vector (3,) from the sample's middle to the lamp, view frame."""
        way = self._lamp(joints)
        return np.asarray(self.view_from_arm @ (way / np.linalg.norm(way)))

    def lamp_position_mm(self, joints: Joints) -> F64:
        """Return where the lamp is (3,), view frame, from the sample's middle, in millimetres.

        Raises
        ------
        ValueError
            The arm has no radius in RIG.toml.
        """
        if self.radius_mm is None:
            raise ValueError("the lamp's position is known only if RIG.toml has the arm's radius_mm")
        return np.asarray(self.view_from_arm @ self._lamp(joints))

    def joints(self, azimuth_deg: float, elevation_deg: float) -> Joints:
        """Return the joints that bring the lamp to a direction of the view frame, azimuth in [0, 360).

        The lamp lies where the ray from the sample meets the sphere of the arm's radius about its elevation joint.
        """
        ray = self.view_from_arm.T @ direction_from_angles(azimuth_deg, elevation_deg)
        around_deg, up_deg = angles_from_direction(ray)
        if self.radius_mm is None:
            return Joints(around_deg, up_deg)
        rise = self.pivot_height_mm * float(ray[2])
        length_mm = rise + math.sqrt(rise * rise + self.radius_mm**2 - self.pivot_height_mm**2)
        sine = (length_mm * float(ray[2]) - self.pivot_height_mm) / self.radius_mm
        return Joints(around_deg, math.degrees(math.asin(max(-1.0, min(1.0, sine)))))

    def _lamp(self, joints: Joints) -> F64:
        along = direction_from_angles(joints.azimuth_deg, joints.elevation_deg)
        if self.radius_mm is None:
            return along
        return np.asarray(self.radius_mm * along + np.array([0.0, 0.0, self.pivot_height_mm]))
