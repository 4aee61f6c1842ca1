"""Diffuse gain: shading that changes more with the light, of the same brightest light and brightness."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM
from processing.ptm.model import Ptm
from processing.ptm.relighting.brightest import brightest_light

F32 = NDArray[np.float32]
_ROWS = 64


def gain_diffuse(ptm: Ptm, gain: float, source: str = "the material") -> Ptm:
    """Scale the second derivatives of the polynomials by g about their maximum (Malzbender and others, 2001).

    A pixel's polynomial f becomes f(l₀) + ∇f(l₀)·(l − l₀) + g·½(l − l₀)ᵀH(l − l₀), H its second derivatives and l₀
    where its luminance is largest. A maximum inside the disc, where ∇f = 0, keeps its place and its value. Where there
    is none, l₀ is the brightest point of the unit circle, at which value and slope are kept. In an RGB material
    luminance is the mean of the channels, and l₀ is common to them, so that the colour at l₀ is kept too.

    Parameters
    ----------
    gain : g ≥ 0; 1 changes nothing, 1.5 to 4 bring out relief
    source : names the material in errors

    Raises
    ------
    InputError
        The material is not a polynomial with second derivatives.
    """
    if ptm.basis != PTM:
        raise InputError(
            f"{source}: is a {ptm.basis}, and diffuse gain scales the second derivatives of a {PTM}; fit one, or use "
            "--unsharp or --specular, which take any material"
        )
    coefficients = np.zeros_like(ptm.coefficients)
    for top in range(0, ptm.shape[0], _ROWS):
        strip = slice(top, top + _ROWS)
        coefficients[:, strip] = _gained(ptm.coefficients[:, strip], gain)
    return replace(ptm, coefficients=coefficients)


def _gained(coefficients: F32, gain: float) -> NDArray[np.float64]:
    """Change (6, h, W, C)."""
    polynomials = coefficients.astype(np.float64)
    u, v = np.moveaxis(brightest_light(polynomials.mean(axis=-1)), -1, 0)[..., None]
    a0, a1, a2, a3, a4, a5 = polynomials
    rest = 1 - gain
    return np.stack(
        [
            gain * a0,
            gain * a1,
            gain * a2,
            a3 + rest * (2 * a0 * u + a2 * v),
            a4 + rest * (2 * a1 * v + a2 * u),
            a5 - rest * (a0 * u * u + a1 * v * v + a2 * u * v),
        ]
    )
