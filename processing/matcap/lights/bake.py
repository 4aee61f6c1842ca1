"""Maps with the lights in them that were added by hand."""

from dataclasses import replace

import numpy as np

from processing.matcap.lights.footprints import footprint
from processing.matcap.lights.hung import hung_maps
from processing.matcap.model import Component, DecomposedMatcap
from processing.paraboloid.maps import texel_directions


def baked(component: Component) -> Component:
    """Render a component's lights into its maps, blurred by its filter; what is taken away ends at black."""
    if not component.lights and not component.pictures:
        return component
    size = component.front.shape[0]
    sides = []
    for texels, directions in zip((component.front, component.back), texel_directions(size), strict=True):
        light = texels.astype(np.float64)
        for painted in component.lights:
            light += footprint(painted, directions, component.filter_size)[..., None] * np.asarray(painted.colour)
        sides.append(light)
    for hung in component.pictures:
        for side, added in zip(sides, hung_maps(hung, size, component.filter_size), strict=True):
            side += added
    front, back = (np.maximum(side, 0).astype(np.float32) for side in sides)
    return replace(component, front=front, back=back, lights=(), pictures=())


def baked_matcap(matcap: DecomposedMatcap) -> DecomposedMatcap:
    return replace(matcap, low=baked(matcap.low), high=baked(matcap.high))
