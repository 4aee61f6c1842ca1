"""The quadratic programme of the diffuse environment, solved exactly by few of its constraints (the Shape paper, 3.1).

A fit that has to stay above every pixel touches nine of them at most. It is solved for a sample of the pixels by a dual
active-set method, as the paper's for all of them is one (that of Goldfarb and Idnani); those that rise furthest above
the result are added, until none does.
"""

from dataclasses import dataclass

import daqp
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.shape.diffuse.passes import F32, F64, I64, furthest_above, sums
from processing.shape.harmonics import TERMS, evaluate

_SAMPLE = 3000
_MOST_ROUNDS = 60
_TIGHT = 1e-13
"""Of the brightest pixel: what a pixel may rise above the fit by rounding."""
_TOLD_APART = 1e-11
"""Of the largest singular value: what is smaller is a combination of harmonics that the normals do not tell from 0."""
_TOLERANCES = (1e-14, 1e-11, 1e-8)
_UNBOUNDED = 1e30
"""The solver's word for no bound."""
_SOLVED = 1
_RESOLVED = 1e-14
"""Of the largest eigenvalue: smaller ones are rounding, and are found at the next look."""
_LIKE_ONE = 1e-5
_MOST_LOOKS = 4


@dataclass(frozen=True)
class Basis:
    """Combinations of the harmonics whose squares add up to one over the pixels, so that a fit is a projection.

    Attributes
    ----------
    combined : (9, K) coefficients of each combination; K < 9 where the normals do not tell all nine apart
    projected : (K, C) least-squares fit in them
    condition : of the normal equations
    """

    combined: F64
    projected: F64
    condition: float

    @property
    def least_squares(self) -> F64:
        """Coefficients (9, C) of the least-squares fit."""
        coefficients: F64 = self.combined @ self.projected
        return coefficients


def basis_of(normals: F32, shading: F32, ridge: float) -> Basis:
    """Sum up what the fits need to know of all pixels.

    Parameters
    ----------
    normals : (N, 3) unit
    shading : (N, C)
    ridge : penalty on the squares of all coefficients but the first, as a share of the mean square of the harmonics
    """
    gram, moments = (total / len(normals) for total in sums(normals, shading))
    shrunk = ridge * np.trace(gram) / TERMS * np.diag([0.0] + [1.0] * (TERMS - 1))
    gram += shrunk
    condition, largest = float(np.linalg.cond(gram)), float(np.linalg.norm(gram, 2))
    combined = np.eye(TERMS)
    for look in range(1, _MOST_LOOKS + 1):
        values, vectors = np.linalg.eigh(gram)
        turn = vectors / np.sqrt(np.maximum(values, _RESOLVED * values[-1]))
        kept = np.linalg.norm(combined @ turn, axis=0) * np.sqrt(largest) < 1 / _TOLD_APART
        combined, moments = combined @ turn[:, kept], turn[:, kept].T @ moments
        if values[0] > _LIKE_ONE * values[-1] or look == _MOST_LOOKS:
            break
        # Sums of products have lost half the digits; those of what is nearly orthonormal do not.
        gram, moments = (total / len(normals) for total in sums(normals, shading, combined))
        gram += combined.T @ shrunk @ combined
    return Basis(combined, moments, condition)


def fit_above(normals: F32, shading: F32, basis: Basis, floor: F64 | None = None) -> F64:
    """Find the coefficients (9, C) that come closest to the shading of all pixels and lie under none.

    Parameters
    ----------
    floor : (M, 3) directions in which the result shall not be negative either
    """
    scales = np.abs(shading).max(axis=0).astype(np.float64)
    scales[scales == 0] = 1
    rows = np.unique(np.linspace(0, len(normals) - 1, min(_SAMPLE, len(normals))).astype(np.int64))
    chosen = [rows] * len(scales)
    coefficients = np.zeros((TERMS, len(scales)))
    changed = np.ones(len(scales), bool)
    for turn in range(_MOST_ROUNDS):
        for c in np.flatnonzero(changed).tolist():
            solution, active = _solve(normals[chosen[c]], shading[chosen[c], c] / scales[c], basis, c, scales[c], floor)
            coefficients[:, c] = solution
            if turn == 0:
                chosen[c] = chosen[c][active]
        excess, pixels = furthest_above(normals, shading, coefficients)
        for c in range(len(scales)):
            more = np.setdiff1d(pixels[excess[:, c] > _TIGHT * scales[c], c], chosen[c])
            chosen[c] = np.concatenate([chosen[c], more])
            changed[c] = more.size > 0
        if not changed.any():
            break
    return coefficients


def _solve(
    normals: F32, shading: NDArray[np.floating], basis: Basis, channel: int, scale: float, floor: F64 | None
) -> tuple[F64, I64]:
    """Solve with these pixels' constraints alone; return the coefficients, and which of the pixels they touch."""
    matrix = evaluate(normals) @ basis.combined
    least = shading.astype(np.float64)
    if floor is not None:
        matrix = np.concatenate([matrix, evaluate(floor) @ basis.combined])
        least = np.concatenate([least, np.zeros(len(floor))])
    target = basis.projected[:, channel] / scale
    for tolerance in _TOLERANCES:
        weights, _, status, told = daqp.solve(
            np.eye(len(target)),
            -target,
            np.ascontiguousarray(matrix),
            np.full(len(least), _UNBOUNDED),
            least,
            primal_tol=tolerance,
        )
        if status == _SOLVED:
            touched = np.flatnonzero(told["lam"][: len(normals)])
            return basis.combined @ weights * scale, touched.astype(np.int64)
    raise InputError("diffuse environment: its normals are too much alike to stay above all pixels; give a ridge")
