"""Rendered pictures into files."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_codes, write_picture
from litrig.base.radiometry import decode_srgb, to_u8
from processing.ptm.model import Ptm
from processing.reference.display import display_codes, over

_KEEPS_ALPHA = frozenset({".png", ".tif", ".tiff"})


def save_rendered(path: Path, picture: NDArray[np.float32], background_srgb: tuple[float, float, float] | None) -> None:
    """Write a rendered picture (H, W, 4), linear light and straight coverage; a background of None leaves it clear.

    Raises
    ------
    InputError
        The file cannot be written, or has no place for transparency.
    """
    if background_srgb is None:
        if path.suffix.lower() not in _KEEPS_ALPHA:
            raise InputError(f"{path}: cannot be transparent; write a .png or .tif, or choose a background colour")
        write_codes(path, display_codes(picture))
        return
    background = decode_srgb(np.asarray(background_srgb, np.float32))
    write_picture(path, over(picture, (float(background[0]), float(background[1]), float(background[2])))[..., :3])


def save_flat(path: Path, values: NDArray[np.float32], ptm: Ptm) -> None:
    """Write a relit PTM: its values as codes to a display format, as light to EXR."""
    if path.suffix.lower() == ".exr":
        write_picture(path, decode_srgb(values) if ptm.space == "srgb" else values)
    else:
        write_codes(path, to_u8(values))
