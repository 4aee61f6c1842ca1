"""A mask that somebody painted over a picture."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.pictures import read_encoded

_WHITE = 0.5


def read_mask(path: Path) -> NDArray[np.bool_]:
    """Read a picture (H, W) as true where any channel is brighter than half.

    Raises
    ------
    InputError, FormatError
        The file is missing, of an unknown format, or damaged.
    """
    mask: NDArray[np.bool_] = read_encoded(path).max(axis=-1) > _WHITE
    return mask
