"""A picture of all directions as the light.

The picture is a panorama in latitude and longitude, twice as wide as high, taken where the sample is and looking
towards the camera: its centre is the direction z, to the camera; its top row is up, +y; a quarter of its width right of
the centre is the view frame's left, −x. What lies behind the sample, its outer quarters, does not light it.
"""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.relighting.lights import Lights

F64 = NDArray[np.float64]


def environment_lights(
    panorama: NDArray[np.floating], rotate_deg: float = 0.0, source: str = "the environment"
) -> Lights:
    """Make every texel above the horizon (z > 0) a light of its radiance times its solid angle over 2π.

    So weighted, the lights of a panorama that is 1 everywhere sum to the mean over the half-sphere.

    Parameters
    ----------
    panorama : (H, 2H, 3), linear
    rotate_deg : turns the panorama about +y, from z towards x: light from behind the camera moves to the right
    source : names the panorama in errors

    Raises
    ------
    InputError
        The panorama is not twice as wide as high, or dark wherever light could come from.
    """
    height, width, _ = panorama.shape
    if width != 2 * height:
        raise InputError(
            f"{source}: {width} × {height} pixels are not twice as wide as high, as a panorama of all directions is; "
            "convert it to latitude and longitude"
        )
    longitude = (0.5 - (np.arange(width) + 0.5) / width) * 2 * np.pi + np.radians(rotate_deg)
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    solid_angle = (edges[:-1] - edges[1:]) * (2 * np.pi / width)
    polar = np.pi * (np.arange(height) + 0.5) / height
    facing = np.cos(longitude) > 0
    directions = _directions(polar, longitude[facing])
    colours = panorama[:, facing].astype(np.float64) * (solid_angle / (2 * np.pi))[:, None, None]
    lit = np.any(colours != 0, axis=-1)
    if not np.any(lit):
        raise InputError(
            f"{source}: black all over its middle half, from where light could come; turn it with --rotate"
        )
    return Lights(directions[lit], colours[lit])


def _directions(polar: F64, longitude: F64) -> F64:
    flat = np.sin(polar)[:, None]
    x, z = flat * np.sin(longitude), flat * np.cos(longitude)
    return np.stack([x, np.broadcast_to(np.cos(polar)[:, None], x.shape), z], axis=-1)
