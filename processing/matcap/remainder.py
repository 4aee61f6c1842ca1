"""What the maps of a component lack of the disc that they are made of.

However large maps are, somewhere they are coarser than the disc: near a slope of 1 the whole rim looks straight behind,
at a few texels. What they lack is a picture of the disc, nearly black, that is added to their light, so that what is
not edited is what went in.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from processing.matcap.disc import disc_normals, rim_distances_px, spread_out
from processing.matcap.model import STILL, Component
from processing.matcap.render import remaining, warped
from processing.paraboloid.read import lookup

F32 = NDArray[np.float32]
Floats = NDArray[np.floating]

_STEP = 2.0**-16
"""Of linear light: a twentieth of the darkest step of 8-bit sRGB. Whole steps pack well."""
_BEYOND_PX = 2.0


def with_remainder(component: Component, disc: Floats) -> Component:
    """Return a component that, unedited, shows a disc.

    Parameters
    ----------
    disc : (P, P, 3) white-balanced light
    """
    side = len(disc)
    normals, inside = disc_normals(side)
    lacking = np.zeros((side, side, 3), np.float32)
    drawn = lookup(component.front, component.back, warped(normals[inside], component.slope))
    step = _step(component)
    lacking[inside] = np.round((disc[inside] - drawn) / step) * step
    if not lacking.any():
        return replace(component, remainder=None)
    # The outermost normals lie between pixels that the disc holds and some that it does not.
    lacking = spread_out(lacking, inside)
    lacking[rim_distances_px(side) < -_BEYOND_PX] = 0
    return replace(component, remainder=lacking)


def with_maps(component: Component, front: F32, back: F32) -> Component:
    """Return a component with other maps of the same light, that shows what it showed."""
    changed = replace(component, front=front, back=back)
    if component.remainder is None:
        return changed
    normals, inside = disc_normals(len(component.remainder))
    directions = warped(normals[inside], component.slope)
    shown = lookup(component.front, component.back, directions)
    disc = np.zeros(component.remainder.shape)
    disc[inside] = shown + remaining(replace(component, light_turn_deg=STILL), directions)
    return with_remainder(changed, disc)


def _step(component: Component) -> float:
    """Return the step of the remainder, a power of two: of display white, or of what is brightest if that is darker."""
    return 2.0 ** math.floor(math.log2(_STEP * min(1 / min(max(*component.base_colour, 1e-30), 1e30), 1.0)))
