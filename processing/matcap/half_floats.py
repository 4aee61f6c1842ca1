"""Maps in half floats, which halve their files: eleven bits are more than light needs that is white-balanced."""

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


def rounded(texels: F32) -> F32:
    """Round to what half floats hold, if they hold anything as bright."""
    nearest = _halves(texels).astype(np.float32)
    return nearest if np.all(np.isfinite(nearest)) else texels


def compact(texels: F32) -> NDArray[np.float32 | np.float16]:
    """Return half floats where these hold the values to the bit, and otherwise the values."""
    halves = _halves(texels)
    return halves if np.array_equal(halves.astype(np.float32), texels) else np.ascontiguousarray(texels, np.float32)


def _halves(texels: F32) -> NDArray[np.float16]:
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(texels, np.float16)
