"""Going once over all pixels: sums for the fit, and the worst pixels under it."""

import itertools
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.shape.harmonics import TERMS, evaluate

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
CHUNKS = 256
_BLOCK = 4096
_WORKERS = 2
T = TypeVar("T")


def sums(normals: F32, shading: F32, combined: F64 | None = None) -> tuple[F64, F64]:
    """Add up the products of K functions with one another (K, K), and with shading (K, C), over all pixels.

    Parameters
    ----------
    combined : (9, K) the functions as combinations of harmonics; the harmonics themselves without
    """
    functions = np.eye(TERMS) if combined is None else combined
    count = functions.shape[1]

    def some(window: slice) -> tuple[F64, F64]:
        gram, moments = np.zeros((count, count)), np.zeros((count, shading.shape[1]))
        for start in range(window.start, window.stop, _BLOCK):
            block = slice(start, min(start + _BLOCK, window.stop))
            values = evaluate(normals[block])
            if combined is not None:
                values = values @ functions
            gram += values.T @ values
            moments += values.T @ shading[block].astype(np.float64)
        return gram, moments

    parts = list(_apart(some, len(normals)))
    return np.sum([gram for gram, _ in parts], axis=0), np.sum([moments for _, moments in parts], axis=0)


def furthest_above(normals: F32, shading: F32, coefficients: F64) -> tuple[F64, I64]:
    """Find, in each of up to 256 runs of pixels and each channel, the pixel that rises furthest above the fit.

    Parameters
    ----------
    normals : (N, 3) unit
    shading : (N, C)
    coefficients : (9, C)

    Returns
    -------
    excess, pixels : (chunks, C)
    """
    polynomial = as_polynomial(coefficients)
    size = max(1, -(-len(normals) // CHUNKS))
    chunks = -(-len(normals) // size)
    excess, pixels = np.full((chunks, shading.shape[1]), -np.inf), np.zeros((chunks, shading.shape[1]), np.int64)
    list(
        _apart(
            lambda window: _furthest(normals, shading, polynomial, size, window.start, window.stop, excess, pixels),
            chunks,
        )
    )
    return excess, pixels


def as_polynomial(coefficients: F64) -> F64:
    """Turn coefficients (9, C) of the harmonics into those of 1, x, y, z, xy, yz, xz, x², y², z², (10, C)."""
    first, second = np.sqrt(3 / (4 * np.pi)), np.sqrt(15 / (4 * np.pi))
    zonal = np.sqrt(5 / (16 * np.pi))
    c = coefficients
    one = np.sqrt(1 / (4 * np.pi)) * c[0] - zonal * c[6]
    linear = [first * c[k] for k in (3, 1, 2)]
    mixed = [second * c[k] for k in (4, 5, 7)]
    squares = [second / 2 * c[8], -second / 2 * c[8], 3 * zonal * c[6]]
    return np.stack([one, *linear, *mixed, *squares])


@kernel
def _furthest(
    normals: F32, shading: F32, polynomial: F64, size: int, first: int, last: int, excess: F64, pixels: I64
) -> None:
    above = np.zeros(size)
    for chunk in range(first, last):
        start = chunk * size
        stop = min(start + size, normals.shape[0])
        for c in range(shading.shape[1]):
            p0, px, py, pz = polynomial[0, c], polynomial[1, c], polynomial[2, c], polynomial[3, c]
            pxy, pyz, pxz = polynomial[4, c], polynomial[5, c], polynomial[6, c]
            pxx, pyy, pzz = polynomial[7, c], polynomial[8, c], polynomial[9, c]
            for n in range(start, stop):
                x, y, z = float(normals[n, 0]), float(normals[n, 1]), float(normals[n, 2])
                value = p0 + x * (px + pxx * x + pxy * y) + y * (py + pyy * y + pyz * z) + z * (pz + pzz * z + pxz * x)
                above[n - start] = shading[n, c] - value
            worst = above[: stop - start].argmax()
            excess[chunk, c] = above[worst]
            pixels[chunk, c] = start + worst


def _apart(task: Callable[[slice], T], count: int) -> Iterator[T]:
    """Run a task over parts of a range, a thread each."""
    bounds = [count * k // _WORKERS for k in range(_WORKERS + 1)]
    with ThreadPoolExecutor(_WORKERS) as pool:
        yield from pool.map(task, (slice(*pair) for pair in itertools.pairwise(bounds)))
