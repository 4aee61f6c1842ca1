"""Splitting slices into a low part, akin to diffuse light, and a high part, akin to gloss.

Diffuse light is a quadratic polynomial of the normal, to a few per cent (Ramamoorthi & Hanrahan 2001, An Efficient
Representation for Irradiance Environment Maps, section 2.1); gloss stands on top of it. So the low part is the
quadratic that runs along the lower edge of the data: an expectile fit (Newey & Powell 1987), least squares in which
what lies below the curve counts far more than what lies above.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

TERMS = 9
_MOST_TEXELS = 4096
_PASSES = 30
_SETTLED = 1e-3


@dataclass(frozen=True)
class Envelope:
    """The quadratic below each slice.

    Attributes
    ----------
    coefficients : (N, 9, 3) float32, of 1, x, y, z, xy, yz, xz, x² − y², 3z² − 1
    """

    coefficients: F32

    def at(self, normals: F64) -> F32:
        """Read it at true unit normals (..., 3): linear light (N, ..., 3), below zero where the quadratic is."""
        values = np.einsum("...t,ntc->n...c", _terms(normals).astype(np.float32), self.coefficients, optimize=True)
        return np.asarray(values, np.float32)

    def below(self, slices: F32, normals: F64) -> F32:
        """Give the low part of slices (N, S, S, 3) whose texels have these true normals (S, S, 3).

        It is neither negative nor above the slices (above zero, where noise took a slice below), so that slices − low
        is a high part that is not negative either; the sum of both is the slices to rounding.
        """
        low = self.at(normals)
        np.minimum(low, slices, out=low)
        return np.maximum(low, 0, out=low)


def fit_envelope(slices: F32, normals: F64, valid: Mask, common: bool = False, weight_above: float = 0.02) -> Envelope:
    """Fit the quadratic along the lower edge of each slice and channel.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    normals : (S, S, 3) true unit normals of the texels; those of a perspective picture's camera table are its own
    valid : (S, S) bool, texels to fit
    common : fit one quadratic to all slices. Diffuse light stays where it is while a highlight turns away, so that this
        follows it better; diffuse light that depends on the tangent goes to the high part
    weight_above : of what lies above the curve, relative to what lies below; smaller follows the edge more closely,
        and its noise too

    Returns
    -------
    envelope : coefficients of every slice
    """
    texels = np.flatnonzero(valid)
    chosen = texels[:: -(-len(texels) // _MOST_TEXELS)]
    terms = _terms(normals.reshape(-1, 3)[chosen]).astype(np.float32)
    light = slices.reshape(len(slices), -1, 3)[:, chosen]
    light = light.transpose(2, 0, 1)[None] if common else light.transpose(0, 2, 1)[:, :, None]
    curves = _expectiles(light.reshape(-1, *light.shape[2:]), terms, weight_above)
    coefficients = curves.reshape(-1, 3, TERMS).swapaxes(1, 2)
    return Envelope(np.array(np.broadcast_to(coefficients, (len(slices), TERMS, 3))))


def lower_envelope(slices: F32, normals: F64, valid: Mask) -> F32:
    """Give the low part (N, S, S, 3) of slices at true normals; the high part is what is left of them."""
    return fit_envelope(slices, normals, valid).below(slices, normals)


def _expectiles(light: F32, terms: F32, weight_above: float) -> F32:
    """Fit each row of light (F, L, P), L values at every texel, by terms (P, 9) with asymmetric weights; (F, 9)."""
    products = (terms[:, :, None] * terms[:, None, :]).reshape(len(terms), -1)
    ridge = 1e-6 * float(np.trace(terms.T @ terms)) * weight_above * np.eye(TERMS, dtype=np.float32)
    curves = np.zeros((len(light), TERMS), np.float32)
    weights = np.ones_like(light)
    for _ in range(_PASSES):
        moments = (weights.mean(axis=1) @ products).reshape(-1, TERMS, TERMS) + ridge
        curves = np.linalg.solve(moments, ((weights * light).mean(axis=1) @ terms)[..., None])[..., 0]
        above = light > (curves @ terms.T)[:, None]
        after = np.where(above, np.float32(weight_above), np.float32(1))
        if np.mean(after != weights) < _SETTLED:
            break
        weights = after
    return curves


def _terms(normals: F64) -> F64:
    x, y, z = np.moveaxis(normals, -1, 0)
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, x * z, x * x - y * y, 3 * z * z - 1], axis=-1)
