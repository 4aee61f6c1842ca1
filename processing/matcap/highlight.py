"""Where a MatCap's main highlight comes from."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import LUMINANCE
from processing.matcap.lights.bake import baked
from processing.matcap.model import Component
from processing.paraboloid.blur import blurred
from processing.paraboloid.maps import texel_directions

F64 = NDArray[np.float64]
_STEADY_RAD = 0.05
_AS_BRIGHT = 0.7


def main_highlight(component: Component) -> F64:
    """Return the unit direction, in the maps, of the brightest light.

    It is found in a slightly blurred copy, lest a speck of noise wins, and is the middle of what is nearly as bright
    and near it, so that a clipped highlight counts by its middle.
    """
    whole = baked(component)
    size = whole.front.shape[0]
    sides = blurred(whole.front, whole.back, _STEADY_RAD**2)
    directions = np.stack(texel_directions(size))
    squared = (directions[0, ..., :2] ** 2).sum(axis=-1)
    within = np.broadcast_to((squared <= 1) & (directions[0, ..., 2] >= 0), (2, size, size))
    area = np.broadcast_to((1 + directions[0, ..., 2]) ** 2, within.shape)[within]
    light = (np.stack(sides) @ LUMINANCE)[within]
    towards = directions[within]
    brightest = towards[np.argmax(light)]
    near = (towards @ brightest > np.cos(np.radians(30))) & (light >= _AS_BRIGHT * light.max())
    middle = (towards[near] * (area[near] * light[near])[:, None]).sum(axis=0)
    return np.asarray(middle / max(np.linalg.norm(middle), 1e-30)) if light.max() > 0 else np.array([0.0, 0.0, 1.0])
