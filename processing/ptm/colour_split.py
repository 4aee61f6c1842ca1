"""Luminance times colour, as near to three polynomials as can be."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_ROUNDS = 3
# Loops over a tile have no branches, so that the processor works on many pixels at a time.
_TILE = 512
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
    root = np.linalg.cholesky(gram).T.astype(np.float32)
    size = coefficients.shape[1:-1]
    columns = np.ascontiguousarray(coefficients.reshape(len(coefficients), -1, 3), np.float32)
    luminance = np.zeros(columns.shape[:2], np.float32)
    colour = np.zeros((columns.shape[1], 3), np.float32)
    _split(columns, np.ascontiguousarray(root), luminance, colour)
    return luminance.reshape(-1, *size, 1), colour.reshape(*size, 3)


@kernel
def _split(columns: F32, root: F32, luminance: F32, colour: F32) -> None:
    terms, pixels, _ = columns.shape
    planes = np.zeros((terms, 3, _TILE), np.float32)
    turned = np.zeros((3, _TILE), np.float32)
    products = np.zeros((6, _TILE), np.float32)
    hue, share = np.zeros((3, _TILE), np.float32), np.zeros(_TILE, np.float32)
    for first in range(0, pixels, _TILE):
        width = min(_TILE, pixels - first)
        for term in range(terms):
            for channel in range(3):
                _take(columns[term, first : first + width, channel], planes[term, channel])
        products[:] = 0
        for row in range(terms):
            turned[:] = 0
            for column in range(row, terms):
                for channel in range(3):
                    _add(root[row, column], planes[column, channel], turned[channel])
            _multiply(turned[0], turned[1], turned[2], products)
        hue[:] = 1
        for _ in range(_ROUNDS + 1):
            _iterate(products, hue)
        _share(hue, share)
        for channel in range(3):
            colour[first : first + width, channel] = hue[channel, :width]
        for term in range(terms):
            _project(planes[term], hue, share, luminance[term, first : first + width])


@kernel
def _take(values: F32, plane: F32) -> None:
    for place in range(len(values)):
        plane[place] = values[place]


@kernel
def _add(factor: np.float32, plane: F32, sums: F32) -> None:
    for place in range(_TILE):
        sums[place] += factor * plane[place]


@kernel
def _multiply(red: F32, green: F32, blue: F32, products: F32) -> None:
    for place in range(_TILE):
        products[0, place] += red[place] * red[place]
        products[1, place] += red[place] * green[place]
        products[2, place] += red[place] * blue[place]
        products[3, place] += green[place] * green[place]
        products[4, place] += green[place] * blue[place]
        products[5, place] += blue[place] * blue[place]


@kernel
def _iterate(products: F32, hue: F32) -> None:
    """Multiply the colours by AᵀGA, and scale their largest channel to 1; white where there is none."""
    nothing, one = np.float32(0), np.float32(1)
    for place in range(_TILE):
        red, green, blue = hue[0, place], hue[1, place], hue[2, place]
        rr, rg, rb = products[0, place], products[1, place], products[2, place]
        gg, gb, bb = products[3, place], products[4, place], products[5, place]
        new_red = max(rr * red + rg * green + rb * blue, nothing)
        new_green = max(rg * red + gg * green + gb * blue, nothing)
        new_blue = max(rb * red + gb * green + bb * blue, nothing)
        largest = max(max(new_red, new_green), new_blue)
        black = largest < _BLACK
        scale = one / (one if black else largest)
        hue[0, place] = one if black else new_red * scale
        hue[1, place] = one if black else new_green * scale
        hue[2, place] = one if black else new_blue * scale


@kernel
def _share(hue: F32, share: F32) -> None:
    for place in range(_TILE):
        red, green, blue = hue[0, place], hue[1, place], hue[2, place]
        share[place] = np.float32(1) / (red * red + green * green + blue * blue)


@kernel
def _project(planes: F32, hue: F32, share: F32, luminance: F32) -> None:
    for place in range(len(luminance)):
        luminance[place] = share[place] * (
            planes[0, place] * hue[0, place] + planes[1, place] * hue[1, place] + planes[2, place] * hue[2, place]
        )
