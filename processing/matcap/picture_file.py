"""The picture of a decomposed MatCap's ball as a file."""

from pathlib import Path

from litrig.base.pictures import write_picture
from processing.matcap.model import DecomposedMatcap
from processing.matcap.render import disc_picture


def write_disc(path: Path, matcap: DecomposedMatcap, size: int | None = None) -> None:
    """Write the ball as a picture: linear light to EXR, display values to the rest.

    Parameters
    ----------
    size : side in pixels; None is that of the picture that was taken apart

    Raises
    ------
    InputError
        The ending is of no picture, or the file cannot be written.
    """
    write_picture(path, disc_picture(matcap, size))
