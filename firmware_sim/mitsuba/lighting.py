"""Light on the sample: a studio of our own making that does not move, or the lamp on the arm.

Directions are in the view frame (x right, y up, z to the camera) and point from the sample to the light. The studio is
a warm softbox from the upper left, a rim light from below, and an environment with a cool fill, a cold glow at the back
and a gentle gradient. The softboxes are so far away that all of a sphere sees them in one direction.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_sim.scene.pose import F32, Pose

Light = dict[str, Any]
F64 = NDArray[np.float64]

SOFTBOX_DISTANCE_RADII = 60.0
ENVIRONMENT_ROWS = 128
AMBIENT = 0.0006
"""Radiance of a dark room, which the lamp never has quite for itself."""
# direction, half-sides as angles in degrees (across, up), radiance
KEY = ((-0.55, 0.65, 0.75), (24.0, 17.0), (1.80, 1.65, 1.43))
RIM = ((0.35, -0.85, 0.22), (24.0, 9.0), (1.67, 1.33, 1.05))
# direction, angular radius in degrees, radiance
FILL = ((0.85, 0.10, 0.65), 19.0, (0.84, 1.00, 1.24))
BACK = ((-0.80, -0.35, 0.05), 15.0, (0.80, 1.10, 1.60))
ZENITH, NADIR = (0.093, 0.105, 0.125), (0.022, 0.020, 0.018)


def light_direction(azimuth_deg: float, elevation_deg: float) -> F64:
    """Return the unit vector to the lamp: azimuth from x to y, elevation from there to z."""
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def environment() -> F32:
    """Paint the studio's surroundings.

    Returns
    -------
    radiance : (H, 2H, 3) float32 in mitsuba's layout: y is up, row 0 looks straight up, column 0 looks along −z, and
        columns go from there over +x to +z
    """
    directions = map_directions(ENVIRONMENT_ROWS)
    height = (0.5 + 0.5 * directions[..., 1:2]) ** 1.5
    radiance = height * np.array(ZENITH) + (1 - height) * np.array(NADIR)
    for middle, radius_deg, colour in (FILL, BACK):
        radiance = radiance + _glow(directions, middle, radius_deg)[..., None] * np.array(colour)
    return np.asarray(radiance, np.float32)


def map_directions(rows: int) -> F64:
    """Return the unit direction of every texel of an environment map, (rows, 2·rows, 3)."""
    polar = math.pi * (np.arange(rows) + 0.5) / rows
    turn = math.tau * (np.arange(2 * rows) + 0.5) / (2 * rows)
    across = np.sin(polar)[:, None]
    up = np.broadcast_to(np.cos(polar)[:, None], (rows, 2 * rows))
    return np.stack([across * np.sin(turn), up, -across * np.cos(turn)], axis=-1)


def studio(mitsuba: Any) -> dict[str, Light]:  # the module, which has no types of its own
    """Return the softboxes and the environment."""
    return {
        "environment": {"type": "envmap", "bitmap": mitsuba.Bitmap(environment())},
        "key": _softbox(mitsuba, *KEY),
        "rim": _softbox(mitsuba, *RIM),
    }


def dark_room() -> Light:
    # Few samples go to what is hardly there; the lamp would be noisy for want of them.
    return {"type": "constant", "radiance": {"type": "rgb", "value": AMBIENT}, "sampling_weight": 0.001}


def far_lamp(mitsuba: Any) -> Light:
    """Return a lamp whose light makes a white diffuse surface that faces it 1; `lamp_pose` brings it into place."""
    return {
        "type": "directional",
        "to_world": mitsuba.ScalarTransform4f(),
        "irradiance": {"type": "rgb", "value": math.pi},
    }


def near_lamp(distance_radii: float) -> Light:
    """Return a small lamp that has the same effect as the far one on the sample's middle."""
    return {
        "type": "point",
        "position": [0.0, 0.0, distance_radii],
        "intensity": {"type": "rgb", "value": math.pi * distance_radii**2},
    }


def far_lamp_pose(mitsuba: Any, pose: Pose) -> Any:
    """Return the transformation that makes a directional lamp's +z the way its light goes."""
    way = [float(-component) for component in light_direction(pose.azimuth_deg, pose.elevation_deg)]
    up = [0.0, 1.0, 0.0] if abs(way[1]) < 0.9 else [1.0, 0.0, 0.0]
    return mitsuba.ScalarTransform4f().look_at(origin=[0, 0, 0], target=way, up=up)


def _softbox(
    mitsuba: Any,
    middle: tuple[float, float, float],
    half_sides_deg: tuple[float, float],
    radiance: tuple[float, float, float],
) -> Light:
    place = np.array(middle) / np.linalg.norm(middle) * SOFTBOX_DISTANCE_RADII
    across, up = (SOFTBOX_DISTANCE_RADII * math.tan(math.radians(half)) for half in half_sides_deg)
    transform = mitsuba.ScalarTransform4f()
    to_world = transform.look_at(origin=place.tolist(), target=[0, 0, 0], up=[0, 1, 0])
    return {
        "type": "rectangle",
        "to_world": to_world @ transform.scale([across, up, 1.0]),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": list(radiance)}},
    }


def _glow(directions: F64, middle: tuple[float, float, float], radius_deg: float) -> F64:
    """Return a disc of light with soft edges: 1 within, 0 from twice the radius on."""
    cosine = directions @ (np.array(middle) / np.linalg.norm(middle))
    off = np.degrees(np.arccos(np.clip(cosine, -1, 1))) / radius_deg
    edge = np.clip(2 - off, 0, 1)
    return np.asarray(edge * edge * (3 - 2 * edge))
