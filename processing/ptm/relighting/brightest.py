"""Where a polynomial of six terms is brightest: the light that a pixel likes best."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_SAMPLES, _STEPS = 32, 5


def brightest_light(polynomials: NDArray[np.floating]) -> F64:
    """Find the maximum of polynomials over the unit disc of (u, v).

    It is where the gradient vanishes (Malzbender, Gelb, Wolters, Polynomial Texture Maps, 2001), if that point is a
    maximum (D > 0 and a0 < 0, D = 4·a0·a1 − a2²) and lies on the disc. Otherwise the polynomial is largest somewhere on
    the circle, and that point is taken, as viewers do.

    Parameters
    ----------
    polynomials : (6, ...), in the order u², v², uv, u, v, 1

    Returns
    -------
    lights : (..., 2), u and v, u² + v² ≤ 1; a polynomial that is constant on the circle has any of its points
    """
    a0, a1, a2, a3, a4 = np.asarray(polynomials, np.float64)[:5]
    determinant = 4 * a0 * a1 - a2 * a2
    peaked = (determinant > 0) & (a0 < 0)
    divisor = np.where(peaked, determinant, 1)
    inside = np.stack([a2 * a4 - 2 * a1 * a3, a2 * a3 - 2 * a0 * a4], axis=-1) / divisor[..., None]
    peaked &= np.sum(inside**2, axis=-1) <= 1
    angle = _brightest_on_circle(a0, a1, a2, a3, a4)
    return np.where(peaked[..., None], inside, np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def _brightest_on_circle(a0: F64, a1: F64, a2: F64, a3: F64, a4: F64) -> F64:
    """Find the angle of the largest value: the best of a few samples, then Newton's steps that stay beside it."""
    # On the circle the polynomial is a cosine of the angle, one of twice the angle, and a constant.
    double_cos, double_sin = (a0 - a1) / 2, a2 / 2
    angles = 2 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    waves = np.stack([np.cos(angles), np.sin(angles), np.cos(2 * angles), np.sin(2 * angles)], axis=1)
    values = np.tensordot(waves, np.stack([a3, a4, double_cos, double_sin]), axes=1)
    start = angles[np.argmax(values, axis=0)]
    spacing = angles[1]
    found = start
    for _ in range(_STEPS):
        c, s, cc, ss = np.cos(found), np.sin(found), np.cos(2 * found), np.sin(2 * found)
        slope = a4 * c - a3 * s + 2 * (double_sin * cc - double_cos * ss)
        bend = -a3 * c - a4 * s - 4 * (double_cos * cc + double_sin * ss)
        step = np.where(bend < 0, -slope / np.where(bend < 0, bend, 1), 0)
        found = np.clip(found + step, start - spacing, start + spacing)
    return np.asarray(found, np.float64)
