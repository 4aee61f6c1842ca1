"""Whether lights can carry a basis, and the matrix that fits it."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import Basis

F64 = NDArray[np.float64]

LARGEST_CONDITION = 1e3
_SAME_LIGHT = 1e-3


def fitting_matrix(basis: Basis, light_dirs: NDArray[np.floating], ridge: float = 0.0) -> F64:
    """Return the matrix (T, N) that fits: coefficients = fitting matrix · values.

    Parameters
    ----------
    light_dirs : (N, 3) unit, view frame, sample to light
    ridge : how much large coefficients are held down, all but the constant one, beside the mean of the squared terms;
        0 is least squares

    Raises
    ------
    InputError
        The lights cannot carry the basis and nothing holds the coefficients down: too few, all alike, in one line, or
        on one ring of elevation, on which u² + v² is the constant term again. Lights that are all alike are refused in
        any case.
    """
    check_lights(basis, light_dirs, ridge)
    design = basis.evaluate(light_dirs)
    if not ridge:
        return np.asarray(np.linalg.pinv(design), np.float64)
    return np.asarray(np.linalg.solve(design.T @ design + np.diag(ridge_weights(design, ridge)), design.T), np.float64)


def ridge_weights(design: F64, ridge: float) -> F64:
    """Return what is added to the diagonal of designᵀ·design, (T,); nothing for a constant term."""
    constant = (np.ptp(design, axis=0) < 1e-9) & (np.abs(design[0]) > 1e-9)
    held: F64 = np.where(constant, 0.0, ridge * np.sum(design**2) / design.shape[1])
    return held


def check_lights(basis: Basis, light_dirs: NDArray[np.floating], ridge: float = 0.0, source: str = "lights") -> None:
    """Refuse lights that cannot carry a basis, as `fitting_matrix` says; `source` names them in errors."""
    directions: F64 = np.asarray(light_dirs, np.float64)
    if not np.all(np.isfinite(directions)):
        raise InputError(f"{source}: a direction is not a number; measure the lights again")
    distinct = len(np.unique(np.round(directions / _SAME_LIGHT).astype(np.int64), axis=0))
    if distinct == 1 and len(directions) > 1:
        raise InputError(
            f"{source}: all {len(directions)} lights come from 1 direction, which cannot carry a {basis}; mend "
            "their directions, or capture with a lamp that moves"
        )
    if ridge:
        return
    if distinct < basis.terms:
        raise InputError(
            f"{source}: {len(directions)} lights from {distinct} directions cannot carry a {basis}; capture at least "
            f"{basis.terms}, better {5 * basis.terms}, spread over the dome, or fit fewer terms or with --ridge 0.01"
        )
    condition = condition_of(basis.evaluate(directions))
    if not condition <= LARGEST_CONDITION:
        raise InputError(
            f"{source}: {_describe(directions)}, which cannot carry a {basis}: the fit would raise noise "
            f"{condition:.0e} times. Capture lights at several azimuths and at two elevations or more, or fit fewer "
            "terms or with --ridge 0.01"
        )


def condition_of(design: F64) -> float:
    """Return the ratio of the largest to the smallest singular value."""
    values = np.linalg.svd(design, compute_uv=False)
    return float(values[0] / max(values[-1], 1e-300))


def _describe(light_dirs: F64) -> str:
    """Say what is wrong with lights that cannot tell the terms apart."""
    flat = light_dirs[:, :2]
    radii = np.hypot(*flat.T)
    if np.ptp(radii) < 0.05:
        elevation_deg = float(np.degrees(np.arccos(np.clip(radii.mean(), 0, 1))))
        return f"all lights stand on one ring, {elevation_deg:.0f} deg above the sample"
    if np.linalg.svd(flat - flat.mean(axis=0), compute_uv=False)[1] < 0.05 * np.sqrt(len(flat)):
        return "all lights stand in one line"
    return "the lights lie on one curve (as a ring or a cross does), or leave most of the dome empty"
