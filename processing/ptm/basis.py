"""The six terms of a polynomial texture map, and whether lights can tell them apart."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F64 = NDArray[np.float64]

TERMS = 6
_LARGEST_CONDITION = 1e3
_SAME_LIGHT = 1e-3


def design_matrix(light_dirs: NDArray[np.floating]) -> F64:
    """Evaluate the terms u², v², uv, u, v, 1 (Synthesis and Rendering of 3D Textures, equation 8).

    Parameters
    ----------
    light_dirs : (N, 2) or (N, 3), unit, view frame, sample to light; (u, v) are its x and y

    Returns
    -------
    design : (N, 6) float64
    """
    u, v = np.asarray(light_dirs, np.float64)[:, :2].T
    return np.stack([u * u, v * v, u * v, u, v, np.ones_like(u)], axis=1)


def fitting_matrix(light_dirs: NDArray[np.floating]) -> F64:
    """Return the pseudo-inverse (6, N) of the design matrix: coefficients = fitting matrix · values.

    Raises
    ------
    InputError
        The lights cannot carry six terms: too few, all alike, all in one plane, or one ring of elevation, on which
        u² + v² is the constant term again.
    """
    directions: F64 = np.asarray(light_dirs, np.float64)
    design = design_matrix(directions)
    if not np.all(np.isfinite(design)):
        raise InputError("a light direction is not a number; measure the lights again")
    distinct = len(np.unique(np.round(directions[:, :2] / _SAME_LIGHT).astype(np.int64), axis=0))
    if distinct < TERMS:
        raise InputError(
            f"{len(directions)} lights from {distinct} directions cannot carry the {TERMS} terms of a PTM; "
            f"capture at least {TERMS}, better 30, spread over the dome"
        )
    values = np.linalg.svd(design, compute_uv=False)
    condition = values[0] / max(values[-1], 1e-300)
    if not condition <= _LARGEST_CONDITION:
        raise InputError(
            f"{_describe(directions)}; the fit would raise noise {condition:.0e} times. Capture lights at several "
            "azimuths and at two elevations or more"
        )
    return np.asarray(np.linalg.pinv(design), np.float64)


def _describe(light_dirs: F64) -> str:
    """Say what is wrong with lights that cannot tell six terms apart."""
    flat = light_dirs[:, :2]
    radii = np.hypot(*flat.T)
    if np.ptp(radii) < 0.05:
        elevation_deg = float(np.degrees(np.arccos(np.clip(radii.mean(), 0, 1))))
        return f"all lights stand on one ring, {elevation_deg:.0f} deg above the sample"
    if np.linalg.svd(flat - flat.mean(axis=0), compute_uv=False)[1] < 0.05 * np.sqrt(len(flat)):
        return "all lights stand in one line"
    return "the lights lie on one curve of second degree (as a ring or a cross does)"
