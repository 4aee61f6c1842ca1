"""A sphere on the camera's axis: which of its points a table normal asks for, and where that point is in the picture.

The sphere's centre is the origin, its radius 1, the eye at (0, 0, d). Everything lies in one plane with the axis, so
that a direction is its angle from z: ψ for the normal (and the point), β for the ray at the eye, χ = ψ + β between
normal and ray, with sin χ = d sin β.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.camera_model import FARTHEST_RADII
from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal

F64 = NDArray[np.float64]

# The share of the ray's angle β by which the table turns a normal; exact in the plane of normal, ray and axis.
_SHARE = {TableNormal.CAMERA: 0.0, TableNormal.RECTIFIED: 0.5, TableNormal.VIEW: 1.0}
_MOST_STEPS, _CLOSE_RAD = 100, 1e-12


@dataclass(frozen=True)
class SphereView:
    """How the camera sees the sphere.

    Attributes
    ----------
    table_normal : how normals are brought to the table
    distance_radii : camera to sphere centre in radii; None for an orthographic picture
    """

    table_normal: TableNormal = TableNormal.RECTIFIED
    distance_radii: float | None = None

    def __post_init__(self) -> None:
        if self.distance_radii is not None and not 1 < self.distance_radii <= FARTHEST_RADII:
            raise InputError(
                f"the camera cannot stand {self.distance_radii:g} radii from the sphere's centre; "
                f"measure again, in radii of the sphere (more than 1, at most {FARTHEST_RADII:g})"
            )

    @property
    def keeps_normals(self) -> bool:
        """Whether the table normal is the true one."""
        return self.distance_radii is None or self.table_normal is TableNormal.CAMERA

    def largest_table_angle_rad(self) -> float:
        """Angle ψ′ from z of the table normal at the silhouette: beyond it nothing was seen."""
        if self.distance_radii is None:
            return np.pi / 2
        rim_rad = np.arccos(1 / self.distance_radii)
        return float(rim_rad + _SHARE[self.table_normal] * (np.pi / 2 - rim_rad))

    def true_angle_rad(self, table_angle_rad: F64) -> F64:
        """Invert the table's turn: solve ψ + s·β(ψ) = ψ′ for ψ, s = 0, ½, 1 for camera, rectified, view.

        Exact to rounding by Newton's method: the left side rises ever less steeply up to the silhouette, so that from 0
        every step falls short and none too far. Angles beyond the silhouette's give the silhouette's.
        """
        target = np.minimum(table_angle_rad, self.largest_table_angle_rad())
        if self.distance_radii is None:
            return target
        distance, share = self.distance_radii, _SHARE[self.table_normal]
        angle = np.zeros_like(target)
        for _ in range(_MOST_STEPS):
            slope = 1 + share * (distance * np.cos(angle) - 1) / (distance**2 - 2 * distance * np.cos(angle) + 1)
            step = (target - angle - share * self._ray_angle_rad(angle)) / slope
            angle = angle + step
            if np.all(np.abs(step) < _CLOSE_RAD):
                break
        return np.minimum(angle, np.arccos(1 / distance))

    def image_radius(self, true_angle_rad: F64) -> F64:
        """Distance from the circle's centre at which the point with normal angle ψ is seen; the silhouette is 1.

        tan β / tan βmax with sin βmax = 1/d; sin ψ without perspective.
        """
        if self.distance_radii is None:
            return np.sin(true_angle_rad)
        rim_slope = 1 / np.sqrt(self.distance_radii**2 - 1)
        radius: F64 = np.tan(self._ray_angle_rad(true_angle_rad)) / rim_slope
        return radius

    def _ray_angle_rad(self, true_angle_rad: F64) -> F64:
        assert self.distance_radii is not None  # noqa: S101  # for the type checker: no ray without a distance
        return np.arctan2(np.sin(true_angle_rad), self.distance_radii - np.cos(true_angle_rad))


def texel_plane(size: int, supersample: int = 1) -> tuple[F64, F64]:
    """Return n_x and n_y at the centres of an S×S table's texels, or of their n×n parts; each (S·n, S·n), row 0 on top.

    n_x = (2·column + 1)/S − 1, and n_y = 1 − (2·row + 1)/S.
    """
    count = size * supersample
    line = (2 * np.arange(count) + 1) / count - 1
    n_x, n_y = np.meshgrid(line, -line)
    return n_x, n_y
