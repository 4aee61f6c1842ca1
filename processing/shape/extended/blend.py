"""Extended surfaces, whose light is not the same everywhere: several environments that go over into one another.

The Shape paper leaves this to future work (its section 6). A pixel's weights are those of Gaussians about the regions'
centres, of sum 1. What is blended is the picture shaded with each: that is the same as blending environments, but where
shading is held at 0.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from processing.shape.model import Environments, ShadingBuffers, SurfaceEnvironment

F64 = NDArray[np.float64]
Picture = NDArray[Any]


def region_weights(centres: NDArray[np.floating], falloff: float, positions: NDArray[np.floating]) -> F64:
    """Return what each region counts at positions (..., 3): (..., K), of sum 1."""
    away = np.asarray(positions, np.float64)[..., None, :] - np.asarray(centres, np.float64)
    exponents = -np.sum(away**2, axis=-1) / (2 * falloff**2)
    # Far from all of them the nearest still counts.
    values = np.exp(exponents - exponents.max(axis=-1, keepdims=True))
    weights: F64 = values / values.sum(axis=-1, keepdims=True)
    return weights


def recompose_regions(
    shade: Callable[..., Picture],
    buffers: ShadingBuffers,
    environments: Environments,
    normals: NDArray[np.floating],
    **factors: Any,
) -> Picture:
    """Shade a picture again, its extended surfaces with a blend of the light of their regions.

    Parameters
    ----------
    shade : `recompose.recompose`, or the reference's
    factors : handed on to it

    Returns
    -------
    picture : as `shade` returns it; what it leaves alone keeps its bits
    """
    rounds = max((len(one.regions) for one in environments.values()), default=0)
    first = shade(buffers, _round(environments, 0), normals, **factors)
    total = first.copy()
    for turn in range(1, rounds):
        weights = np.zeros(buffers.shape)
        for number, one in environments.items():
            if turn < len(one.regions):
                here = buffers.surfaces == number
                centres = np.stack([region.centre for region in one.regions])
                weights[here] = region_weights(centres, one.falloff, buffers.positions[here])[:, turn]
        picture = shade(buffers, _round(environments, turn), normals, **factors)
        changed = picture != first
        step = np.where(changed, picture, 0) - np.where(changed, first, 0)
        total = np.where(changed, total + weights[..., None] * step, total).astype(first.dtype)
    return total


def _round(environments: Environments, turn: int) -> Mapping[int, SurfaceEnvironment]:
    """Let each surface have the light of one of its regions; of the first, when it has no more."""
    chosen = {}
    for number, one in environments.items():
        of_region = one.regions[turn if turn < len(one.regions) else 0].environment if one.regions else one
        chosen[number] = replace(of_region, regions=(), falloff=0.0)
    return chosen
