"""Materials whose normals are known: a Lambert sphere, fitted in any basis."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import encode_srgb
from processing.ptm.basis import PTM, TERMS, Basis
from processing.ptm.conditioning import fitting_matrix
from processing.ptm.model import Colour, Ptm, Space
from tests.processing.ptm.relief import dome

F64 = NDArray[np.float64]

BASES = [Basis(kind, terms) for kind, numbers in TERMS.items() for terms in numbers]
TINT = np.array([1.0, 0.6, 0.3])


def sphere_normals(size: int = 33, steepest_deg: float = 75.0) -> F64:
    """Normals (S, S, 3); beyond the rim, flat ones."""
    y, x = np.mgrid[size - 1 : -size : -2, 1 - size : size : 2] / (size - 1) * np.sin(np.radians(steepest_deg))
    flat = np.minimum(x * x + y * y, 1)
    ball = np.stack([x, y, np.sqrt(1 - flat)], axis=-1)
    return np.where((flat <= np.sin(np.radians(steepest_deg)) ** 2)[..., None], ball, [0.0, 0.0, 1.0])


def lambert(
    normals: F64, basis: Basis = PTM, space: Space = "srgb", colour: Colour = "lrgb", lowest_deg: float = 20
) -> Ptm:
    """Fit a coloured Lambert surface of albedo 0.7·TINT under 50 lights; LRGB of grey light times the tint."""
    lights = dome(50, lowest_deg)
    tint = np.ones(1) if colour == "lrgb" else TINT
    light = 0.7 * np.maximum(np.moveaxis(normals @ lights.T, -1, 0), 0)[..., None] * tint
    values = encode_srgb(light) if space == "srgb" else light
    coefficients = np.tensordot(fitting_matrix(basis, lights), values, axes=1).astype(np.float32)
    factor = np.broadcast_to(TINT, normals.shape).astype(np.float32) if colour == "lrgb" else None
    return Ptm(coefficients, factor, space, "sphere", basis)


def angles_deg(a: NDArray[np.floating], b: NDArray[np.floating]) -> F64:
    return np.asarray(np.degrees(np.arccos(np.clip(np.sum(a * b, axis=-1), -1, 1))), np.float64)
