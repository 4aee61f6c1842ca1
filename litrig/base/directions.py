"""Light directions in the view frame: x right, y up, z from the sample towards the camera."""

import math

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


def direction_from_angles(azimuth_deg: float, elevation_deg: float) -> F64:
    """Return the unit vector (3,) to the light; azimuth counts from x towards y, elevation from the xy plane to z."""
    azimuth_rad, elevation_rad = math.radians(azimuth_deg), math.radians(elevation_deg)
    flat = math.cos(elevation_rad)
    return np.array([flat * math.cos(azimuth_rad), flat * math.sin(azimuth_rad), math.sin(elevation_rad)])


def angles_from_direction(direction: NDArray[np.floating]) -> tuple[float, float]:
    """Return azimuth in [0, 360) and elevation in degrees of a vector (3,) of any length but zero."""
    x, y, z = (float(component) for component in direction)
    length = math.sqrt(x * x + y * y + z * z)
    if not length > 0:
        raise ValueError("a direction of length zero has no angles")
    azimuth_deg = math.degrees(math.atan2(y, x)) % 360
    return (0.0 if azimuth_deg == 360 else azimuth_deg), math.degrees(math.asin(max(-1.0, min(1.0, z / length))))


def turn_between_deg(a_deg: float, b_deg: float) -> float:
    """Return by how much less than half a turn, either way, an angle a differs from b: −180 up to 180."""
    return (a_deg - b_deg + 180) % 360 - 180


def angle_between_deg(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    """Return the angle between two vectors in degrees; exact also where the cosine is flat."""
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(a, b))), float(np.dot(a, b))))
