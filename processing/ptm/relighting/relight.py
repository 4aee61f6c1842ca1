"""A picture of a material under a light: the NumPy truth that shaders are tested against."""

import numpy as np
from numpy.typing import NDArray

from processing.ptm.model import Ptm

F32 = NDArray[np.float32]


def relight(ptm: Ptm, light: NDArray[np.floating]) -> F32:
    """Evaluate a material at one light (Synthesis and Rendering of 3D Textures, equation 8).

    Parameters
    ----------
    light : (2,) or (3,), view frame, sample to light; (u, v) are its first two components

    Returns
    -------
    picture : (H, W, 3) float32 in the material's own space; it may leave 0..1, and nothing is cut off here
    """
    terms = ptm.basis.evaluate(light).astype(np.float32)
    values: F32 = np.tensordot(terms, ptm.coefficients, axes=1)
    return values if ptm.colour is None else values * ptm.colour
