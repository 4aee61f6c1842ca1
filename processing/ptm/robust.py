"""Fits that shadows and highlights do not pull: each pixel gives its pictures weights.

`trimmed` leaves out the darkest and the brightest pictures of a pixel; `reweighted` then lowers the weight of whatever
is far from the fit, round by round (Geman and McClure's function of the residual, its scale from the median).
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Robust = Literal["no", "trimmed", "reweighted"]

ROUNDS = 8
DARKEST, BRIGHTEST = 0.2, 0.1
"""Shares of a pixel's pictures that `trimmed` leaves out."""
# A residual of so many robust standard deviations has a quarter of the weight.
_REACH = 2.5
# Half a step of eight bits: nothing is told apart below.
_FINEST = 0.5 / 255
_LEAST_PIVOT = 1e-4


def fit_weighted(values: F32, design: F64, held: F64, plain: F32, robust: Robust) -> tuple[F32, F32]:
    """Fit each pixel by itself, with weights that its three channels share.

    Parameters
    ----------
    values : (N, P, 3)
    design : (N, 1, T) terms at each light, or (N, P, T) where they differ from pixel to pixel (near lights)
    held : (T,) added to the diagonal of the normal equations, as `ridge_weights` gives it
    plain : (T, P, 3) coefficients to fall back on where the weighted pictures cannot carry the basis

    Returns
    -------
    coefficients : (T, P, 3)
    weights : (N, P) 0..1; all 1 where the pixel fell back
    """
    count, pixels, _ = values.shape
    coefficients = np.ascontiguousarray(plain, np.float32).copy()
    weights = np.ones((count, pixels), np.float32)
    low, high = (round(DARKEST * count), round(BRIGHTEST * count)) if robust != "no" else (0, 0)
    rounds = ROUNDS if robust == "reweighted" else 0
    _fit(np.ascontiguousarray(values), np.ascontiguousarray(design), held, low, high, rounds, coefficients, weights)
    return coefficients, weights


@kernel
def _fit(
    values: F32, design: F64, held: F64, low: int, high: int, rounds: int, coefficients: F32, weights: F32
) -> None:
    count, pixels, _ = values.shape
    terms = design.shape[2]
    normal, right = np.zeros((terms, terms)), np.zeros((terms, 3))
    light = np.zeros(count)
    weight = np.zeros(count)
    for pixel in range(pixels):
        at = pixel if design.shape[1] > 1 else 0
        for picture in range(count):
            light[picture] = values[picture, pixel, 0] + values[picture, pixel, 1] + values[picture, pixel, 2]
            weight[picture] = 1.0
        order = np.argsort(light)
        for place in range(low):
            weight[order[place]] = 0.0
        for place in range(high):
            weight[order[count - 1 - place]] = 0.0
        for repeat in range(rounds + 1):
            if not _solve(values, design, held, pixel, at, weight, normal, right):
                break
            for term in range(terms):
                for channel in range(3):
                    coefficients[term, pixel, channel] = right[term, channel]
            for picture in range(count):
                weights[picture, pixel] = weight[picture]
            if repeat == rounds:
                break
            for picture in range(count):
                total = 0.0
                for channel in range(3):
                    left = -float(values[picture, pixel, channel])
                    for term in range(terms):
                        left += design[picture, at, term] * right[term, channel]
                    total += left * left
                light[picture] = np.sqrt(total / 3)
            scale = _REACH * max(1.4826 * np.median(light), _FINEST)
            for picture in range(count):
                weight[picture] = 1 / (1 + (light[picture] / scale) ** 2) ** 2


@kernel
def _solve(values: F32, design: F64, held: F64, pixel: int, at: int, weight: F64, normal: F64, right: F64) -> bool:
    """Solve the normal equations of one pixel in place of `right`; says whether they could be."""
    count, terms = len(weight), design.shape[2]
    normal[:] = 0
    right[:] = 0
    for picture in range(count):
        if weight[picture] == 0:
            continue
        for row in range(terms):
            weighted = weight[picture] * design[picture, at, row]
            for column in range(row + 1):
                normal[row, column] += weighted * design[picture, at, column]
            for channel in range(3):
                right[row, channel] += weighted * values[picture, pixel, channel]
    for row in range(terms):
        normal[row, row] += held[row]
    for row in range(terms):  # Cholesky, in place
        before = normal[row, row]
        for column in range(row + 1):
            total = normal[row, column]
            for inner in range(column):
                total -= normal[row, inner] * normal[column, inner]
            if column < row:
                normal[row, column] = total / normal[column, column]
            elif total > _LEAST_PIVOT * before:
                normal[row, row] = np.sqrt(total)
            else:
                return False
    for channel in range(3):
        for row in range(terms):
            for inner in range(row):
                right[row, channel] -= normal[row, inner] * right[inner, channel]
            right[row, channel] /= normal[row, row]
        for row in range(terms - 1, -1, -1):
            for inner in range(row + 1, terms):
                right[row, channel] -= normal[inner, row] * right[inner, channel]
            right[row, channel] /= normal[row, row]
    return True
