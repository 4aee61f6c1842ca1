"""Normals from a fitted material, without its pictures."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import decode_srgb
from processing.ptm.model import Ptm

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_LIGHTS, _LOWEST_DEG = 64, 20.0
# From here on down are attached shadows, which are not Lambert; from there on up is gloss.
_DARKEST_RANK, _BRIGHTEST_RANK = 0.4, 0.9
_PLANE_TERMS = 3
_ROWS = 16


def normals_of(ptm: Ptm) -> F32:
    """Estimate normals: the Lambert surface that comes nearest to a pixel under many lights.

    The material is evaluated at lights all over the half-sphere, as linear light. Of these values the darkest 40 % and
    the brightest 10 % are set aside, pixel by pixel, and n is the direction of the b with the least squared error of
    b·l. The direction of the largest value, which viewers take, is several times less accurate: fits are flat there.
    A polynomial of three terms is a plane, of which nothing is to be set aside.

    Returns
    -------
    normals : (H, W, 3) float32, unit, view frame, z ≥ 0; (0, 0, 1) where the light makes no difference
    """
    directions = _spread(_LIGHTS, _LOWEST_DEG)
    terms = ptm.basis.evaluate(directions).astype(np.float32)
    normals = np.zeros((*ptm.shape, 3), np.float32)
    trimmed = ptm.basis.terms > _PLANE_TERMS
    for top in range(0, ptm.shape[0], _ROWS):
        strip = slice(top, top + _ROWS)
        normals[strip] = _lambert(_brightness(ptm, strip, terms), directions, trimmed=trimmed)
    return normals


def _brightness(ptm: Ptm, rows: slice, terms: F32) -> F32:
    """Return linear light (h, W, N) at N lights; of a coloured pixel that of its strongest channel."""
    coefficients, colour = ptm.strip(rows)
    if colour is not None:
        coefficients = coefficients * colour.max(axis=-1, keepdims=True)
    values = np.moveaxis(np.tensordot(terms, coefficients, axes=1), 0, -2)
    light = decode_srgb(values) if ptm.space == "srgb" else values
    return np.asarray(light.mean(axis=-1), np.float32)


def _lambert(values: F32, directions: F64, *, trimmed: bool) -> F64:
    """Fit values (h, W, N) by b·l and return b's direction (h, W, 3)."""
    kept = np.ones_like(values)
    if trimmed:
        low, high = (int(rank * (len(directions) - 1)) for rank in (_DARKEST_RANK, _BRIGHTEST_RANK))
        ranked = np.partition(values, (low, high), axis=-1)
        kept = ((values >= ranked[..., low, None]) & (values <= ranked[..., high, None])).astype(np.float32)
    products = np.einsum("ni,nj->nij", directions, directions).reshape(-1, 9).astype(np.float32)
    # Half the lights or more are kept, and they are spread over an area: the matrix can always be inverted.
    moments = (kept @ products).reshape(*kept.shape[:-1], 3, 3).astype(np.float64)
    vector = np.linalg.solve(moments, ((kept * values) @ directions.astype(np.float32))[..., None])[..., 0]
    vector[..., 2] = np.maximum(vector[..., 2], 0)
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    found = length > 1e-9
    return np.where(found, vector / np.where(found, length, 1), [0.0, 0.0, 1.0])


def _spread(count: int, lowest_deg: float) -> F64:
    """Spread directions (N, 3) evenly from the top down to an elevation, on a spiral."""
    z = 1 - (np.arange(count) + 0.5) / count * (1 - np.sin(np.radians(lowest_deg)))
    azimuth = np.arange(count) * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - z * z)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z], axis=-1)
