"""The isotropic material that differs least from an anisotropic one (the AMC paper, section 5.3)."""

import numpy as np
from numpy.typing import NDArray

from processing.amc.model import Amc


def isotropic_matcap(amc: Amc) -> NDArray[np.float32]:
    """Average all slices in linear light: the MatCap (S, S, 3) float32 with the least squared difference to each."""
    mean: NDArray[np.float32] = amc.slices.mean(axis=0, dtype=np.float64).astype(np.float32)
    return mean
