"""Turns of the object by hand, as unit quaternions: no direction is special, and none locks.

A turn takes the object's frame into the view frame. Places in the picture are `Spot`s: x to the right and y up from its
middle, in halves of its shorter side.
"""

import math

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Turn = tuple[float, float, float, float]
"""A unit quaternion (w, x, y, z)."""
Spot = tuple[float, float]

UNTURNED: Turn = (1.0, 0.0, 0.0, 0.0)


def spot_at(place: tuple[float, float], size: tuple[float, float]) -> Spot:
    """Return the spot at a place in pixels from the upper left corner of a picture of that size."""
    half = min(size) / 2
    return (place[0] - size[0] / 2) / half, (size[1] / 2 - place[1]) / half


def about(axis: tuple[float, float, float], angle_rad: float) -> Turn:
    """Turn about a unit vector of the view frame, counter-clockwise as seen from where it points to."""
    half = angle_rad / 2
    x, y, z = (math.sin(half) * part for part in axis)
    return math.cos(half), x, y, z


def then(first: Turn, second: Turn) -> Turn:
    """Turn by one, then by another in the frame that stands still; rounding does not add up."""
    w, x, y, z = first
    a, b, c, d = second
    product = (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )
    length = math.hypot(*product)
    w, x, y, z = (part / length for part in product)
    return w, x, y, z


def arc(start: Spot, end: Spot, radius: float) -> Turn:
    """Turn a ball in the picture's middle so that what was under one spot comes under another.

    Parameters
    ----------
    radius : of the ball, in halves of the picture's shorter side. Beyond 1/√2 of it the ball goes over into a funnel
        that never ends, so that spots beside it turn the object about the line of sight (Bell's trackball)
    """
    before, after = _on_ball(start, radius), _on_ball(end, radius)
    # The quaternion of twice half the angle: halfway between no turn and the product of the two.
    x, y, z = (float(part) for part in np.cross(before, after))
    w = 1 + float(before @ after)
    length = math.hypot(w, x, y, z)
    if length < 1e-9:  # from a place to the one behind it; two spots of the ball's front never are
        return UNTURNED
    return w / length, x / length, y / length, z / length


def matrix(turn: Turn) -> F64:
    """Return the rotation (3, 3)."""
    w, x, y, z = turn
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def of_angles(yaw_deg: float, pitch_deg: float, roll_deg: float = 0.0) -> Turn:
    """Return the turn of a `View` with these angles."""
    yaw = about((0, 1, 0), math.radians(yaw_deg))
    pitch = about((1, 0, 0), math.radians(pitch_deg))
    return then(then(yaw, pitch), about((0, 0, 1), math.radians(roll_deg)))


def angles_deg(turn: Turn) -> tuple[float, float, float]:
    """Return yaw, pitch (−90..90) and roll of the `View` that is turned so; roll is 0 where yaw does the same."""
    rotation = matrix(turn)
    upright = math.hypot(rotation[2, 0], rotation[2, 2])
    pitch = math.degrees(math.atan2(rotation[2, 1], upright))
    if upright < 1e-9:
        return math.degrees(math.atan2(rotation[0, 2], rotation[0, 0])), pitch, 0.0
    yaw = math.degrees(math.atan2(-rotation[2, 0], rotation[2, 2]))
    return yaw, pitch, math.degrees(math.atan2(-rotation[0, 1], rotation[1, 1]))


def _on_ball(spot: Spot, radius: float) -> F64:
    """Return the unit vector to the ball, or the funnel, under a spot."""
    x, y = spot[0] / radius, spot[1] / radius
    square = x * x + y * y
    z = math.sqrt(1 - square) if square <= 0.5 else 0.5 / math.sqrt(square)
    place = np.array([x, y, z])
    unit: F64 = place / np.linalg.norm(place)
    return unit
