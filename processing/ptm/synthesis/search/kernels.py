"""Orthonormal vectors that hold most of what neighbourhoods differ by, for the paper's rejection (section VII).

Singular vectors come from the neighbourhoods themselves. Cosines, Haar wavelets and Walsh–Hadamard functions are known
beforehand: they are made for whole blocks, a plane at a time, cut down to the known pixels, sorted by how much the
neighbourhoods vary along them, and made orthonormal again, which the cut had undone.
"""

from typing import Literal

import numpy as np
import scipy.fft
import scipy.linalg
from numpy.typing import NDArray

F64 = NDArray[np.float64]
KernelKind = Literal["svd", "dct", "haar", "walsh"]

KERNEL_KINDS: tuple[KernelKind, ...] = ("svd", "dct", "haar", "walsh")
_LOWEST_FREQUENCIES = 8
_WEAKEST = 1e-4


def rejection_kernels(kind: KernelKind, sample: F64, known: NDArray[np.bool_], count: int) -> F64:
    """Choose vectors over the known pixels of a block.

    Parameters
    ----------
    sample : (N, p, K) neighbourhoods out of the source, p known pixels of K planes
    known : (B, B)
    count : how many vectors, at most; what neighbourhoods cannot vary along is left out

    Returns
    -------
    kernels : (k, B, B, K), orthonormal, 0 at unknown pixels; k ≤ count
    """
    pixels, planes = sample.shape[1:]
    vectors = sample.reshape(len(sample), -1)
    vectors = vectors - vectors.mean(axis=0)
    if kind == "svd":
        found = _singular(vectors, count)
    else:
        waves = _waves(kind, known.shape[0])[:, known]
        pool = np.einsum("wp,kl->wkpl", waves, np.eye(planes)).reshape(-1, pixels * planes)
        lengths = np.linalg.norm(pool, axis=1)
        pool = pool[lengths > 1e-9] / lengths[lengths > 1e-9, None]
        energy = np.square(vectors @ pool.T).sum(axis=0)
        found = pool[np.argsort(-energy, kind="stable")[: 2 * count]]
        found = _orthonormal_rows(found)[:count]
    kernels = np.zeros((len(found), *known.shape, planes))
    kernels[:, known] = found.reshape(len(found), pixels, planes)
    return kernels


def _singular(vectors: F64, count: int) -> F64:
    """Find the first right singular vectors, by the products of all pairs: there are few of these."""
    squares, left = np.linalg.eigh(vectors @ vectors.T)
    lengths = np.sqrt(np.maximum(squares[::-1][:count], 0))
    # Of weaker ones rounding would leave vectors that are not at right angles.
    strong = int(np.sum(lengths > _WEAKEST * max(lengths[0], np.finfo(np.float64).tiny)))
    return np.asarray((left[:, ::-1][:, :strong] / lengths[:strong]).T @ vectors, np.float64)


def _orthonormal_rows(vectors: F64) -> F64:
    """Make vectors orthonormal in their order, and drop those that the ones before span already."""
    q, r = np.linalg.qr(vectors.T)
    return np.asarray(q.T[np.abs(np.diag(r)) > 1e-6], np.float64)


def _waves(kind: KernelKind, side: int) -> F64:
    """Return the functions of lowest frequency on a block, (W, side, side)."""
    size = 1 << (side - 1).bit_length()
    count = min(side, _LOWEST_FREQUENCIES)
    if kind == "dct":
        lines = scipy.fft.idct(np.eye(side), axis=0, norm="ortho").T
    elif kind == "haar":
        lines = _haar(size)
    else:
        hadamard = scipy.linalg.hadamard(size).astype(np.float64)
        lines = hadamard[np.argsort(np.count_nonzero(np.diff(hadamard, axis=1), axis=1), kind="stable")]
    lines = lines[:count, :side]
    return np.asarray(np.einsum("ay,bx->abyx", lines, lines).reshape(-1, side, side), np.float64)


def _haar(size: int) -> F64:
    """Return Haar's functions (size, size), from coarse to fine."""
    rows = np.ones((1, 1))
    while rows.shape[1] < size:
        half = rows.shape[1]
        rows = np.concatenate([np.kron(rows, [1, 1]), np.kron(np.eye(half), [1, -1]) * np.sqrt(half)])
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True), np.float64)
