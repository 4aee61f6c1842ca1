"""Layers that were multiplied by their coverage, as compositors like them, brought back to what the surface shows."""

import numpy as np
from numpy.typing import NDArray

from processing.shape.buffers.pixels import Tell

F32 = NDArray[np.float32]
_LEAST_COVERAGE = 1 / 64
_LEAST_PIXELS = 4
_COLOURS = frozenset({"diffuse", "reflection", "albedo", "reflection_albedo"})


def is_premultiplied(picture: F32, parts: F32, coverage: F32, shown: NDArray[np.bool_]) -> bool:
    """Tell whether the parts of the shading are multiplied by coverage already.

    Where a pixel is covered in part, over black, the picture is then their sum, and not the sum times the coverage.
    Over anything but black there is no telling, and they are taken as the paper has them.

    Parameters
    ----------
    picture, parts : (H, W, 3), the latter the sum of diffuse and reflected light
    coverage, shown : (H, W), the latter where all three can be used
    """
    rim = shown & (coverage > 0.1) & (coverage < 0.9)
    rim[rim] = parts[rim].max(axis=-1) > 0
    if np.count_nonzero(rim) < _LEAST_PIXELS:
        return False
    seen, whole = picture[rim], parts[rim]
    scale = np.median(np.abs(whole))
    by_sum, by_share = (float(np.median(np.abs(seen - light))) for light in (whole, whole * coverage[rim][:, None]))
    return by_sum < 0.02 * scale and by_sum < 0.25 * by_share


def straight(layer: F32, coverage: F32) -> F32:
    """Divide a layer (H, W, 3) by coverage; where there is hardly any, by the least that counts."""
    partial = (coverage > 0) & (coverage < 1)
    divided: F32 = (layer / np.where(partial, np.maximum(coverage, _LEAST_COVERAGE), 1)[..., None]).astype(np.float32)
    return divided


def straightened(made: dict[str, F32], coverage: F32, shown: NDArray[np.bool_], tell: Tell) -> dict[str, F32]:
    """Return buffers with diffuse and reflected light as they are on the surface.

    Parameters
    ----------
    made : buffers by name, among them picture and diffuse
    shown : (H, W), where they can be used
    """
    parts = np.where(shown[..., None], made["diffuse"], 0)
    if "reflection" in made:
        parts = parts + np.where(shown[..., None], made["reflection"], 0)
    if not is_premultiplied(made["picture"], parts, coverage, shown):
        return made
    tell("the layers were multiplied by alpha; along rims they are divided by it")
    return {name: straight(plane, coverage) if name in _COLOURS else plane for name, plane in made.items()}
