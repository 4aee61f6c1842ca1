"""How an object is turned and looked at."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.reference.camera import Camera

F64 = NDArray[np.float64]

MARGIN = 1.06
"""The unit sphere, in which the object is, leaves this much room around itself."""
_DEPTH = 1.05


class Projection(StrEnum):
    ORTHOGRAPHIC = "orthographic"
    PERSPECTIVE = "perspective"


@dataclass(frozen=True)
class View:
    """A turn of the object in front of a camera that stands still, as its light does.

    Attributes
    ----------
    yaw_deg : turns the object about its own upright axis; positive brings its front to the right
    pitch_deg : then tips it about the view's x axis; positive shows more of its top
    fov_deg : field of view across the shorter side of a perspective picture
    zoom : 1 shows the whole unit sphere
    roll_deg : last, turns the object about the line of sight; positive is counter-clockwise as the camera sees it
    """

    projection: Projection = Projection.PERSPECTIVE
    yaw_deg: float = 0.0
    pitch_deg: float = 0.0
    fov_deg: float = 30.0
    zoom: float = 1.0
    roll_deg: float = 0.0

    def __post_init__(self) -> None:
        angles_deg = (self.yaw_deg, self.pitch_deg, self.roll_deg)
        if not all(map(math.isfinite, angles_deg)):
            yaw, pitch, roll = angles_deg
            raise InputError(f"view: yaw {yaw:g}, pitch {pitch:g} and roll {roll:g} must be finite; give degrees")
        if not 1 <= self.fov_deg <= 120:
            raise InputError(f"view: a field of view of {self.fov_deg:g} deg is outside 1..120 deg")
        if not 0.01 <= self.zoom <= 100:
            raise InputError(f"view: a zoom of {self.zoom:g} is outside 0.01..100")

    def camera(self, size: tuple[int, int]) -> Camera:
        """Return the projection for a picture of `size`, width and height in pixels."""
        shorter = min(size)
        if shorter < 1:
            raise InputError(f"picture: {size[0]} × {size[1]} pixels are none; ask for at least one each way")
        narrow = np.array([shorter / size[0], shorter / size[1]]) * self.zoom
        rotation = _about_z(self.roll_deg) @ _about_x(self.pitch_deg) @ _about_y(self.yaw_deg)
        if self.projection is Projection.ORTHOGRAPHIC:
            return Camera(rotation, _orthographic(narrow / MARGIN), None)
        half_fov_rad = math.radians(self.fov_deg) / 2
        eye_distance = MARGIN / math.sin(half_fov_rad)
        return Camera(rotation, _perspective(narrow / math.tan(half_fov_rad), eye_distance), eye_distance)


def _orthographic(scale: F64) -> F64:
    return np.diag([scale[0], scale[1], -1 / _DEPTH, 1.0])


def _perspective(scale: F64, eye_distance: float) -> F64:
    """Project from (0, 0, eye_distance) along −z; planes at eye_distance ± _DEPTH become −w and w."""
    near, far = eye_distance - _DEPTH, eye_distance + _DEPTH
    stretch, shift = (far + near) / (far - near), 2 * far * near / (far - near)
    clip_from_eye = np.array(
        [[scale[0], 0, 0, 0], [0, scale[1], 0, 0], [0, 0, -stretch, -shift], [0, 0, -1, 0]], np.float64
    )
    eye_from_view = np.eye(4)
    eye_from_view[2, 3] = -eye_distance
    return clip_from_eye @ eye_from_view


def _about_x(angle_deg: float) -> F64:
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def _about_y(angle_deg: float) -> F64:
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _about_z(angle_deg: float) -> F64:
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
