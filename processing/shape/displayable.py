"""Pictures that came with pixels that are no numbers, for files that hold none."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


def displayable(picture: F32, output: Path, tell: Callable[[str], None]) -> F32:
    """Return the picture as it is for an EXR, and with black where it holds no numbers for any other file."""
    if output.suffix.lower() == ".exr":
        return picture
    finite = np.isfinite(picture)
    if lost := int(np.count_nonzero(~finite.all(axis=-1))):
        tell(f"{lost} pixels hold no numbers, and are black in {output.name}")
    return np.where(finite, picture, np.float32(0))
