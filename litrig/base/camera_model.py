"""How a camera sees the sample: CAMERA.toml, and the rays through its pixels.

Pixel coordinates count from the picture's upper left corner, so that the centre of the first pixel is (0.5, 0.5).
"""

from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from litrig.base.config import StrictModel, read_toml

F64 = NDArray[np.float64]

FARTHEST_RADII = 1e6
"""How far a camera may be from a sphere, in radii; beyond, nobody could tell from an orthographic picture."""


class CameraModel(StrictModel):
    """A CAMERA.toml: pinhole with Brown–Conrady distortion, as OpenCV's calibration has it."""

    kind: Literal["pinhole"] = "pinhole"
    """Only pinhole cameras so far; an orthographic picture needs no camera model."""
    width: int = Field(gt=0)
    """Width of the calibrated pictures, in pixels."""
    height: int = Field(gt=0)
    """Height of the calibrated pictures, in pixels."""
    focal_x_px: float = Field(gt=0)
    """Focal length along x, in pixels."""
    focal_y_px: float = Field(gt=0)
    """Focal length along y, in pixels."""
    centre_x_px: float
    """Principal point, from the left edge."""
    centre_y_px: float
    """Principal point, from the top edge."""
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """k1, k2, p1, p2, k3."""

    def sphere_distance_radii(self, image_radius_px: float) -> float:
        """Distance of the camera to the centre of a sphere on its axis, in radii, from its image."""
        return sphere_distance_radii(image_radius_px, (self.focal_x_px + self.focal_y_px) / 2)


def read_camera_model(path: Path) -> CameraModel:
    """Read a CAMERA.toml."""
    return read_toml(path, CameraModel)


def sphere_distance_radii(image_radius_px: float, focal_px: float) -> float:
    """Distance of the camera to the centre of a sphere, in radii, from its image; the sphere lies on the axis.

    The silhouette is seen at βmax with sin βmax = 1/d, and its image has the radius f·tan βmax.
    """
    return float(np.hypot(1.0, focal_px / image_radius_px))
