"""Environments for the regions of an extended surface, held to that of the whole where a region tells nothing."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape import harmonics
from processing.shape.diffuse.fit import DiffuseOptions, fit_diffuse
from processing.shape.extended.blend import region_weights
from processing.shape.extended.divide import divide
from processing.shape.model import Region, ShadingBuffers, SurfaceEnvironment
from processing.shape.reflection.environment import ReflectionOptions, reconstruct_reflection

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
_SHARE = 0.1
"""Weight from which on a pixel tells of a region's light."""
_RIDGE = 1e-3
"""On what a region's diffuse light differs from the whole surface's."""


@dataclass(frozen=True)
class Light:
    """The light to reconstruct, (H, W, 3), and which pixels (H, W) tell of it."""

    diffuse: F32
    diffuse_told: Mask
    reflection: F32
    reflection_told: Mask


def with_regions(
    whole: SurfaceEnvironment,
    buffers: ShadingBuffers,
    light: Light,
    count: int,
    diffuse: DiffuseOptions,
    reflection: ReflectionOptions,
) -> SurfaceEnvironment:
    """Divide a surface by its positions, and reconstruct each region from its own pixels and some around.

    Raises
    ------
    InputError
        The surface does not have so many places.
    """
    told = light.diffuse_told & light.reflection_told
    if not told.any():
        raise InputError("regions: no pixel tells of both diffuse and reflected light; leave regions out")
    centres, falloff = divide(buffers.positions[told], count)
    weights = np.zeros((*told.shape, count))
    seen = light.diffuse_told | light.reflection_told
    weights[seen] = region_weights(centres, falloff, buffers.positions[seen])
    options = replace(diffuse, ridge=max(diffuse.ridge, _RIDGE), never_negative=False)
    regions = []
    for index, centre in enumerate(centres):
        near = weights[..., index] >= _SHARE
        coefficients, front, back = whole.diffuse, whole.front, whole.back
        if (here := near & light.diffuse_told).any():
            normals = buffers.normals[here]
            left = light.diffuse[here] - (harmonics.evaluate(normals) @ whole.diffuse).astype(np.float32)
            coefficients = whole.diffuse + fit_diffuse(normals, left, options).coefficients
        if (here := near & light.reflection_told).any():
            found = reconstruct_reflection(
                light.reflection,
                buffers.normals,
                buffers.to_eye,
                buffers.positions,
                buffers.reflection_occlusion,
                here,
                reflection,
                (whole.front, whole.back),
            )
            front, back = found.front, found.back
        environment = replace(whole, diffuse=coefficients.astype(np.float32), front=front, back=back)
        regions.append(Region(centre, environment))
    return replace(whole, regions=tuple(regions), falloff=falloff)
