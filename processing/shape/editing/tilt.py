"""Tilting normals, so that they stay unit vectors that face the eye."""

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
GRAZING = 0.02
"""Smallest n·v of a normal that was changed."""


def emboss(normals: F32, beta: float) -> F32:
    """Let surfaces bulge: n with β·n_z in place of n_z, made unit (the Shape paper, section 5).

    Parameters
    ----------
    normals : (H, W, 3), view frame
    beta : 0 to 1; 1 changes nothing
    """
    return unit(normals * np.array([1, 1, beta], np.float32))


def tilted(normals: F32, gradient: F32) -> F32:
    """Raise a surface by a height whose gradient is known: n − (g − (g·n)·n), made unit.

    Only the part of the gradient that lies in the surface counts, so that no tangent frame has to be chosen, and what
    is laid over a slope is drawn out along it.

    Parameters
    ----------
    normals, gradient : (H, W, 3), view frame
    """
    within = gradient - np.sum(gradient * normals, axis=-1, keepdims=True) * normals
    return unit(normals - within)


def detailed(normals: F32, detail: F32) -> F32:
    """Turn detail, whose z is the surface's own normal, by the smallest rotation that takes z to the normal.

    Parameters
    ----------
    normals, detail : (H, W, 3) unit
    """
    x, y, z = np.moveaxis(normals, -1, 0)
    a, b, c = np.moveaxis(detail, -1, 0)
    # Rodrigues about z × n, of which sine and cosine are at hand; −z itself is turned about x.
    along = (x * a + y * b) / np.maximum(1 + z, 1e-6)
    turned = np.stack([a + x * (c - along), b + y * (c - along), z * c - (x * a + y * b)], axis=-1)
    opposite = np.stack([a, -b, -c], axis=-1)
    made = unit(np.where((z < -1 + 1e-6)[..., None], opposite, turned))
    plain = (a == 0) & (b == 0) & (c > 0)
    return np.where(plain[..., None], normals, made)


def blended(old: F32, new: F32, weight: F32, to_eye: F32 | None) -> F32:
    """Go from old normals to new ones by a weight (H, W), and keep what is changed facing the eye, if that is given.

    Where the weight is 0, or nothing differs, the old normal comes back bit by bit.
    """
    mixed = np.where(weight[..., None] >= 1, new, unit(old + weight[..., None] * (new - old)))
    if to_eye is not None:
        facing = np.sum(mixed * to_eye, axis=-1, keepdims=True)
        mixed = np.where(facing < GRAZING, _grazing(mixed, to_eye, facing), mixed)
    changed = (weight > 0) & np.any(new != old, axis=-1) & np.all(np.isfinite(mixed), axis=-1)
    kept: F32 = np.where(changed[..., None], mixed, old).astype(np.float32)
    return kept


def unit(vectors: F32) -> F32:
    """Return vectors (..., 3) of length 1; those of no length stay."""
    with np.errstate(over="ignore"):
        length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not np.all(np.isfinite(length)):
        # Squares that single precision does not hold; what is no number stays so.
        length = np.linalg.norm(vectors.astype(np.float64), axis=-1, keepdims=True)
    made: F32 = (vectors / np.where(length > 0, length, 1)).astype(np.float32)
    return made


def _grazing(normals: F32, to_eye: F32, facing: F32) -> F32:
    """Move normals within their plane with the view until they just face the eye."""
    across = unit(normals - facing * to_eye)
    made: F32 = across * np.float32(np.sqrt(1 - GRAZING**2)) + to_eye * np.float32(GRAZING)
    return made
