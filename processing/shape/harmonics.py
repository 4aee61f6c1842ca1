"""Nine real spherical harmonics, in which diffuse shading is a sum (the Shape paper, section 3.1)."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
TERMS = 9


def evaluate(directions: NDArray[np.floating]) -> F64:
    """Evaluate Y₀₀, Y₁₋₁, Y₁₀, Y₁₁, Y₂₋₂, Y₂₋₁, Y₂₀, Y₂₁, Y₂₂, orthonormal over the sphere.

    Parameters
    ----------
    directions : (..., 3) unit; m counts about z

    Returns
    -------
    values : (..., 9) float64
    """
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    first, second = np.sqrt(3 / (4 * np.pi)), np.sqrt(15 / (4 * np.pi))
    return np.stack(
        [
            np.full_like(x, np.sqrt(1 / (4 * np.pi))),
            first * y,
            first * z,
            first * x,
            second * x * y,
            second * y * z,
            np.sqrt(5 / (16 * np.pi)) * (3 * z * z - 1),
            second * x * z,
            second / 2 * (x * x - y * y),
        ],
        axis=-1,
    )
