"""Which normal indexes an AMC or MatCap table when the picture was taken in perspective.

The table assumes one viewing direction, z. In perspective each surface point is seen along its own ray, so its normal
is turned before the table is asked; the same turn is made when the table is filled from a photograph. All vectors are
in the view frame; `to_eye` points from the surface to the eye.
"""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.floating]


class TableNormal(StrEnum):
    """How a normal seen along an oblique ray is brought to the table's frame."""

    RECTIFIED = "rectified"
    """n′ = (r + z)/|r + z| with r the mirrored ray: exact for mirrors under distant light, best for gloss."""
    VIEW = "view"
    """The smallest rotation of the ray to z, applied whole (the AMC paper's equation 4 as a true rotation)."""
    CAMERA = "camera"
    """n itself: exact for Lambert."""


def table_normals(normals: Vectors, to_eye: Vectors, kind: TableNormal) -> Vectors:
    """Turn normals into the table's frame.

    Parameters
    ----------
    normals : (..., 3) unit, view frame
    to_eye : (..., 3) unit, view frame, from the surface to the eye; (0, 0, 1) everywhere for an orthographic picture

    Returns
    -------
    table normals : (..., 3) unit
    """
    match kind:
        case TableNormal.CAMERA:
            return normals
        case TableNormal.VIEW:
            return rotate_smallest(normals, to_eye, np.array([0.0, 0.0, 1.0], normals.dtype))
        case TableNormal.RECTIFIED:
            mirrored = 2 * np.sum(normals * to_eye, -1, keepdims=True) * normals - to_eye
            half = mirrored + np.array([0.0, 0.0, 1.0], normals.dtype)
            length = np.linalg.norm(half, axis=-1, keepdims=True)
            # The mirrored ray meets −z only at the rim, where the table has no texel; n keeps it finite.
            return np.where(length > 1e-6, half / np.maximum(length, 1e-6), normals)


def table_tangents(tangents: Vectors, normals: Vectors, turned: Vectors) -> Vectors:
    """Turn tangents by the smallest rotation that takes each normal to its table normal."""
    return rotate_smallest(tangents, normals, turned)


def rotate_smallest(vectors: Vectors, source: Vectors, target: Vectors) -> Vectors:
    """Apply to `vectors` the smallest rotation that takes unit `source` to unit `target`; (..., 3) each.

    With s = source + target it is a − s (a·s)/(1 + source·target) + 2 target (a·source). Where the two are opposite the
    rotation is not unique; the result there is finite and of no meaning.
    """
    both = source + target
    cosine = np.sum(source * target, -1, keepdims=True)
    along = np.sum(vectors * both, -1, keepdims=True) / np.maximum(1 + cosine, 1e-9)
    rotated: Vectors = vectors - both * along + 2 * target * np.sum(vectors * source, -1, keepdims=True)
    return rotated
