"""An AMC as a few basis pictures and their curves over k: slice j is about Σ_r curves[j, r] · pictures[r].

What changes over k lives in few dimensions: 6 pictures stand in for the slices of a brushed metal at 39 dB, 10 at 50.
The curves are the left singular vectors of the table, a matrix of slices by valid texels, so that no other pictures of
the same number come nearer (Eckart and Young 1936). By default the mean is taken out first and is the first picture:
that costs next to nothing (0.02 dB and less was seen), and the first picture alone is then the isotropic MatCap.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import helmert

from litrig.base.errors import InputError
from processing.amc.files.meaning import Meaning
from processing.amc.model import Amc

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@dataclass(frozen=True)
class LowRankAmc:
    """A table of pre-lit colour, factored.

    Attributes
    ----------
    pictures : (rank, S, S, 3) float32, linear light, signed, axes as in `Amc.slices`, the one with most energy first
        (after the mean); dilated past the disc of normals
    curves : (D, rank) float32, columns orthogonal with mean square 1; a mean's curve is 1 throughout
    valid : (S, S) bool, what every slice has seen
    meaning : what the table's file says of it
    """

    pictures: F32
    curves: F32
    valid: NDArray[np.bool_]
    meaning: Meaning

    def expand(self) -> Amc:
        """Multiply out. Colours may fall somewhat below 0 beside a sharp highlight; they are left there."""
        slices: F32 = np.tensordot(self.curves, self.pictures, axes=1).astype(np.float32)
        return self.meaning.table(slices, np.broadcast_to(self.valid, slices.shape[:3]))


class RankError(NamedTuple):
    """What a rank costs and yields.

    Attributes
    ----------
    rank : how many pictures
    stored_bytes : of pictures and curves as float32, before packing
    psnr_db : of all valid texels in linear light, against the brightest of them; infinite when nothing is lost
    """

    rank: int
    stored_bytes: int
    psnr_db: float


def compress(amc: Amc, rank: int, *, mean_first: bool = True) -> LowRankAmc:
    """Find the pictures and curves nearest to a table, in least squares of linear light over its valid texels.

    Parameters
    ----------
    rank : 1 to D, pictures to keep
    mean_first : take the mean over k for the first picture

    Raises
    ------
    InputError
        The rank does not lie in 1 to D, a colour is no number, or no texel is valid in every slice.
    """
    _check_rank(amc, rank)
    valid = _always_valid(amc)
    curves = _orthonormal_curves(_gram(amc.slices, valid), mean_first).curves[:, :rank]
    curves = curves * _signs(curves) * np.sqrt(len(curves))
    return LowRankAmc(_pictures(amc.slices, curves), curves.astype(np.float32), valid, Meaning.of(amc))


def error_curve(amc: Amc, ranks: Iterable[int], *, mean_first: bool = True) -> list[RankError]:
    """Tell what each rank would cost and yield, from the singular values alone.

    Raises
    ------
    InputError
        As `compress`.
    """
    valid = _always_valid(amc)
    energies = _orthonormal_curves(_gram(amc.slices, valid), mean_first).energies
    peak = float(np.abs(amc.slices[:, valid]).max())
    values = len(amc.slices) * int(valid.sum()) * 3
    errors = []
    for rank in ranks:
        _check_rank(amc, rank)
        floats = rank * (valid.size * 3 + len(amc.slices))
        errors.append(RankError(rank, 4 * floats, _psnr_db(peak, float(energies[rank:].sum()) / values)))
    return errors


class _Spectrum(NamedTuple):
    """Orthonormal curves (D, D) in columns, and the energy (D,) that each one's picture has."""

    curves: F64
    energies: F64


def _orthonormal_curves(gram: F64, mean_first: bool) -> _Spectrum:
    """Diagonalise the Gram matrix of the slices, beside the constant curve if it is to be the first."""
    count = len(gram)
    inner = helmert(count).T if mean_first else np.eye(count)  # columns orthogonal to the constant, or all
    energies, rotation = np.linalg.eigh(inner.T @ gram @ inner)
    energies, curves = energies[::-1], inner @ rotation[:, ::-1]
    if mean_first:
        curves = np.concatenate([np.full((count, 1), count**-0.5), curves], axis=1)
        energies = np.concatenate([[gram.sum() / count], energies])
    # Below this the digits of the sums are at an end, and what is left is no energy.
    energies = np.where(energies > count * np.finfo(np.float64).eps * np.trace(gram), energies, 0)
    return _Spectrum(curves, energies)


def _gram(slices: F32, valid: NDArray[np.bool_]) -> F64:
    """Multiply every slice with every other, (D, D), over valid texels; row by row, to hold no second table."""
    gram = np.zeros((len(slices), len(slices)))
    for row in np.flatnonzero(valid.any(axis=1)):
        values = slices[:, row, valid[row]].reshape(len(slices), -1).astype(np.float64)
        gram += values @ values.T
    if not np.all(np.isfinite(gram)):
        raise InputError("AMC: holds colours that are no numbers; build it again")
    return gram


def _pictures(slices: F32, curves: F64) -> F32:
    """Project every texel on the curves, also those that were not seen, so that what was dilated stays dilated."""
    depth, rows = slices.shape[:2]
    pictures = np.zeros((curves.shape[1], *slices.shape[1:]), np.float32)
    for row in range(rows):
        pictures[:, row] = np.tensordot(curves.T / depth, slices[:, row].astype(np.float64), axes=1)
    return pictures


def _signs(curves: F64) -> F64:
    """Let every curve be positive where it is first farthest from 0; by itself a curve with its picture has no sign."""
    away = np.abs(curves)
    farthest = (away > 0.999 * away.max(axis=0)).argmax(axis=0)
    signs: F64 = np.sign(np.take_along_axis(curves, farthest[None], axis=0))
    return signs


def _psnr_db(peak: float, mean_square: float) -> float:
    return float("inf") if mean_square == 0 else 10 * float(np.log10(peak**2 / mean_square))


def _always_valid(amc: Amc) -> NDArray[np.bool_]:
    valid: NDArray[np.bool_] = np.asarray(amc.valid.all(axis=0))
    if not valid.any():
        raise InputError("AMC: no texel is valid in every slice; build it again without a mask")
    return valid


def _check_rank(amc: Amc, rank: int) -> None:
    if not 1 <= rank <= len(amc.slices):
        raise InputError(f"AMC: a rank of {rank}; choose 1 to {len(amc.slices)}, the number of its slices")
