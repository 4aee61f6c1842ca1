"""Pictures that are hung into the light, with what they cover."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.pictures import read_coverage, read_linear

F32 = NDArray[np.float32]


def read_with_coverage(path: Path) -> F32:
    """Read a picture (H, W, 4) float32: linear light, and coverage 0..1 from a PNG's or EXR's alpha, else 1.

    Raises
    ------
    InputError, FormatError
        The file is missing, of an unknown format, or damaged.
    """
    light = read_linear(path)  # which says what is wrong with the file
    coverage = read_coverage(path)
    whole = np.ones(light.shape[:2], np.float32) if coverage is None else np.clip(coverage, 0, 1)
    return np.concatenate([light, whole[..., None]], axis=-1, dtype=np.float32)
