"""What a decomposed MatCap looks like at a normal, and the picture of its ball (the MatCap paper, section 5)."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation

from processing.matcap.disc import disc_normals
from processing.matcap.lights.bake import baked, baked_matcap
from processing.matcap.model import Component, DecomposedMatcap, Turn
from processing.paraboloid.read import lookup

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

DEFAULT_SIDE_PX = 512
FADED_DEG = 1.0
_ROUNDING = 1e-6


def disc_picture(matcap: DecomposedMatcap, size: int | None = None) -> F32:
    """Draw the ball that a MatCap is a picture of.

    Parameters
    ----------
    size : side in pixels; None is that of the picture that was taken apart

    Returns
    -------
    picture : (S, S, 3) float32, linear light, the disc inscribed; black outside
    """
    low, high = half_pictures(matcap, size)
    return low + high


def half_pictures(matcap: DecomposedMatcap, size: int | None = None) -> tuple[F32, F32]:
    """Draw the ball as `disc_picture` does, the low and the high frequencies each by themselves."""
    side = size or matcap.picture_size or DEFAULT_SIDE_PX
    normals, valid = disc_normals(side)
    pictures = np.zeros((2, side, side, 3), np.float32)
    for picture, component in zip(pictures, (matcap.low, matcap.high), strict=True):
        with np.errstate(over="ignore", invalid="ignore"):  # what is too bright is not finite, and writers refuse that
            picture[valid] = component_light(component, normals[valid])
    return pictures[0], pictures[1]


def shaded(matcap: DecomposedMatcap, normals: F64) -> F64:
    """Return the colours (N, 3) at unit normals (N, 3) on the visible side, linear light."""
    whole = baked_matcap(matcap)
    return component_light(whole.low, normals) + component_light(whole.high, normals)


def component_light(component: Component, normals: F64) -> F64:
    """Return what one component adds at unit normals (N, 3): its light in `seen` directions times its energy."""
    whole = baked(component)
    directions = seen(whole, normals)
    light = lookup(whole.front, whole.back, directions) + remaining(whole, directions)
    return np.maximum(light, 0) * energy(whole, normals)


def remaining(component: Component, directions: F64) -> F64:
    """Return what the maps lack in their directions (N, 3), as far as the turn of the light lets it be seen: (N, 3).

    Directions that no normal of the disc shows lack nothing.
    """
    share = remainder_share(Rotation.from_rotvec(component.light_turn_deg, degrees=True))
    if component.remainder is None or not share:
        return np.zeros((len(directions), 3))
    normals = unwarped(directions, component.slope)
    size = len(component.remainder)
    across, down = (1 + normals[:, 0]) / 2 * size - 0.5, (1 - normals[:, 1]) / 2 * size - 0.5
    shares = np.where(normals[:, 2] > -_ROUNDING, share, 0)
    return np.stack(
        [
            shares * map_coordinates(component.remainder[..., channel], [down, across], np.float64, 1, mode="nearest")
            for channel in range(3)
        ],
        axis=1,
    )


def remainder_share(light_turn: Rotation) -> float:
    """Return how much of a remainder is seen: 1 under light that is turned about the view axis alone, 0 from 1° off it.

    Details of the rim crowd round one direction behind. There they come apart as they went in; elsewhere they would be
    needles.
    """
    axis = light_turn.apply([0.0, 0.0, 1.0])
    off_deg = float(np.degrees(np.arctan2(np.hypot(axis[0], axis[1]), axis[2])))
    return max(0.0, 1 - off_deg / FADED_DEG)


def energy(component: Component, normals: F64) -> F64:
    """Return α(θ) = α₀ + s(θ) at unit normals (N, 3), (N, 3), not below 0."""
    theta = np.arccos(np.clip(normals[:, 2], -1, 1))
    return np.maximum(np.asarray(component.base_colour) + component.silhouette.added(theta)[:, None], 0)


def seen(component: Component, normals: F64, slopes: F64 | None = None) -> F64:
    """Return the directions of the maps, (N, 3), that unit normals (N, 3) show under the light as it is turned.

    Parameters
    ----------
    slopes : (N,) in place of the component's own
    """
    steep = component.slope if slopes is None else slopes
    omega = warped(turned(normals, component.normal_turn_deg, back=True), steep)
    return turned(omega, component.light_turn_deg, back=True)


def warped(normals: F64, slope: float | F64) -> F64:
    """Turn normals away from the view axis: ω = rot(u, μθ) n about u = e₂ × n/|e₂ × n|, so that θ becomes θ(1 + μ)."""
    across = np.hypot(normals[:, 0], normals[:, 1])
    angle = np.arctan2(across, normals[:, 2]) * (1 + slope)
    # On the view axis any u will do: θ is 0 there.
    outwards = normals[:, :2] / np.where(across > 0, across, 1)[:, None]
    return np.concatenate([outwards * np.sin(angle)[:, None], np.cos(angle)[:, None]], axis=1)


def unwarped(directions: F64, slope: float) -> F64:
    """Return the normals that show directions; those in the blind spot lie beyond the silhouette."""
    return warped(directions, 1 / (1 + slope) - 1)


def turned(vectors: F64, turn_deg: Turn, *, back: bool = False) -> F64:
    """Turn vectors (N, 3), or turn them back."""
    if not any(turn_deg):
        return vectors
    return np.asarray(Rotation.from_rotvec(turn_deg, degrees=True).apply(vectors, inverse=back))
