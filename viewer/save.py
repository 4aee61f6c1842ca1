"""Rendered pictures into files."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import write_codes, write_picture
from litrig.base.radiometry import U8, decode_srgb, to_u8
from processing.reference.display import display_codes, over

_KEEPS_ALPHA = frozenset({".png", ".tif", ".tiff"})
F32 = NDArray[np.float32]
Colour = tuple[float, float, float]


def save_rendered(path: Path, picture: F32, background_srgb: Colour | None) -> None:
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
    write_picture(path, _laid_over(picture, background_srgb))


def save_values(path: Path, values: F32, *, are_display: bool) -> None:
    """Write a flat picture (H, W, 3): its values as codes to a display format, as light to EXR."""
    if path.suffix.lower() == ".exr":
        write_picture(path, decode_srgb(values) if are_display else values)
    else:
        write_codes(path, to_u8(values))


def frame_codes(picture: F32, background_srgb: Colour) -> U8:
    """Make a rendered picture (H, W, 4) the frame of a video, (H, W, 3) sRGB codes."""
    return display_codes(over(picture, _light(background_srgb)))[..., :3]


def _laid_over(picture: F32, background_srgb: Colour) -> F32:
    return np.asarray(over(picture, _light(background_srgb))[..., :3], np.float32)


def _light(colour_srgb: Colour) -> Colour:
    red, green, blue = decode_srgb(np.asarray(colour_srgb, np.float32)).tolist()
    return red, green, blue
