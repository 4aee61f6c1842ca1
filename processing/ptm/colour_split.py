"""Luminance times colour, as near to three polynomials as can be."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_ROUNDS = 3
_TILE = 256
_BLACK = np.float32(1e-20)


def split_colour(coefficients: F32, gram: F64) -> tuple[F32, F32]:
    """Split RGB coefficients into luminance times colour, with the least squared error over the lights.

    For the coefficients A (T, 3) of a pixel and G the mean of the products of the terms over the lights, the best
    colour is the first eigenvector of AᵀGA. A few rounds of power iteration reach it, and keep it positive.

    Parameters
    ----------
    coefficients : (T, ..., 3)
    gram : (T, T), positive definite

    Returns
    -------
    luminance : (T, ..., 1), and colour : (..., 3) with its largest channel 1; neutral where the pixel is black
    """
    # In coordinates in which the terms are orthonormal over the lights, G is no more than the identity.
    root = np.linalg.cholesky(gram).T
    back = np.linalg.inv(root)
    size = coefficients.shape[1:-1]
    columns = np.ascontiguousarray(coefficients.reshape(len(coefficients), -1, 3), np.float32)
    luminance = np.zeros(columns.shape[:2], np.float32)
    colour = np.zeros((columns.shape[1], 3), np.float32)
    _split(columns, root.astype(np.float32), back.astype(np.float32), luminance, colour)
    return luminance.reshape(-1, *size, 1), colour.reshape(*size, 3)


@kernel
def _split(columns: F32, root: F32, back: F32, luminance: F32, colour: F32) -> None:
    terms, pixels, _ = columns.shape
    turned = np.zeros((terms, _TILE, 3), np.float32)
    for first in range(0, pixels, _TILE):
        width = min(_TILE, pixels - first)
        turned[:] = 0
        for row in range(terms):
            for column in range(row, terms):
                factor = root[row, column]
                for place in range(width):
                    for channel in range(3):
                        turned[row, place, channel] += factor * columns[column, first + place, channel]
        for place in range(width):
            rr = rg = rb = gg = gb = bb = np.float32(0)
            for term in range(terms):
                r, g, b = turned[term, place, 0], turned[term, place, 1], turned[term, place, 2]
                rr, rg, rb, gg, gb, bb = rr + r * r, rg + r * g, rb + r * b, gg + g * g, gb + g * b, bb + b * b
            red, green, blue = rr + rg + rb, rg + gg + gb, rb + gb + bb
            for _ in range(_ROUNDS):
                red, green, blue = max(red, np.float32(0)), max(green, np.float32(0)), max(blue, np.float32(0))
                largest = max(red, green, blue)
                if not largest > _BLACK:
                    red = green = blue = np.float32(1)
                    break
                red, green, blue = red / largest, green / largest, blue / largest
                red, green, blue = (
                    rr * red + rg * green + rb * blue,
                    rg * red + gg * green + gb * blue,
                    rb * red + gb * green + bb * blue,
                )
            red, green, blue = max(red, np.float32(0)), max(green, np.float32(0)), max(blue, np.float32(0))
            largest = max(red, green, blue)
            if not largest > _BLACK:
                red = green = blue = largest = np.float32(1)
            red, green, blue = red / largest, green / largest, blue / largest
            colour[first + place, 0], colour[first + place, 1], colour[first + place, 2] = red, green, blue
            share = np.float32(1) / (red * red + green * green + blue * blue)
            for term in range(terms):
                turned[term, place, 0] = share * (
                    turned[term, place, 0] * red + turned[term, place, 1] * green + turned[term, place, 2] * blue
                )
        for row in range(terms):
            for place in range(width):
                total = np.float32(0)
                for column in range(row, terms):
                    total += back[row, column] * turned[column, place, 0]
                luminance[row, first + place] = total
