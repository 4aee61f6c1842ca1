"""The picture of a decomposed MatCap's ball as a file."""

from pathlib import Path

import numpy as np

from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from processing.matcap.model import DecomposedMatcap
from processing.matcap.render import disc_picture


def write_disc(path: Path, matcap: DecomposedMatcap) -> None:
    """Write the ball as a picture, as large as what was taken apart: linear light to EXR, display values to the rest.

    Raises
    ------
    InputError
        The ending is of no picture, the ball is brighter than any file holds, or the file cannot be written.
    """
    picture = disc_picture(matcap)
    if not np.all(np.isfinite(picture)):
        raise InputError(f"{path}: the ball is brighter than files can hold; lessen gains, colours and lights")
    write_picture(path, picture)
