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
# Of what lies above the curve, relative to what lies below: it follows the edge closely, and its noise too.
_WEIGHT_ABOVE = 0.001


@dataclass(frozen=True)
class Envelope:
    """The quadratic below the slices of a turn.

    Attributes
    ----------
    coefficients : (9, 3) float32, of 1, x, y, z, xy, yz, xz, x² − y², 3z² − 1
    """

    coefficients: F32

    def at(self, normals: F64) -> F32:
        """Read it at true unit normals (..., 3): linear light (..., 3), below zero where the quadratic is."""
        return np.asarray(_terms(normals).astype(np.float32) @ self.coefficients, np.float32)

    def below(self, slices: F32, normals: F64) -> F32:
        """Give the low part of slices (N, S, S, 3) whose texels have these true normals (S, S, 3).

        It is neither negative nor above the slices (above zero, where noise took a slice below), so that slices − low
        is a high part that is not negative either; the sum of both is the slices to rounding.
        """
        low = np.minimum(self.at(normals), slices)
        return np.maximum(low, 0, out=low)


def fit_envelope(slices: F32, normals: F64, valid: Mask) -> Envelope:
    """Fit one quadratic a channel along the lower edge of all slices.

    Diffuse light stays where it is while a highlight turns away. Diffuse light that depends on the tangent goes to the
    high part.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    normals : (S, S, 3) true unit normals of the texels; those of a perspective picture's camera table are its own
    valid : (S, S) bool, texels to fit
    """
    texels = np.flatnonzero(valid)
    chosen = texels[:: -(-len(texels) // _MOST_TEXELS)]
    terms = _terms(normals.reshape(-1, 3)[chosen]).astype(np.float32)
    light = slices.reshape(len(slices), -1, 3)[:, chosen].transpose(2, 0, 1)
    return Envelope(_expectiles(light, terms).T.copy())


def _expectiles(light: F32, terms: F32) -> F32:
    """Fit each row of light (F, L, P), L values at every texel, by terms (P, 9) with asymmetric weights; (F, 9)."""
    products = (terms[:, :, None] * terms[:, None, :]).reshape(len(terms), -1)
    ridge = 1e-6 * float(np.trace(terms.T @ terms)) * _WEIGHT_ABOVE * np.eye(TERMS, dtype=np.float32)
    curves = np.zeros((len(light), TERMS), np.float32)
    weights = np.ones_like(light)
    for _ in range(_PASSES):
        moments = (weights.mean(axis=1) @ products).reshape(-1, TERMS, TERMS) + ridge
        curves = np.linalg.solve(moments, ((weights * light).mean(axis=1) @ terms)[..., None])[..., 0]
        above = light > (curves @ terms.T)[:, None]
        after = np.where(above, np.float32(_WEIGHT_ABOVE), np.float32(1))
        if np.mean(after != weights) < _SETTLED:
            break
        weights = after
    return curves


def _terms(normals: F64) -> F64:
    x, y, z = np.moveaxis(normals, -1, 0)
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, x * z, x * x - y * y, 3 * z * z - 1], axis=-1)
