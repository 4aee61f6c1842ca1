"""Blender's MatCaps: one multi-layer OpenEXR with the picture's two halves as passes `diffuse` and `specular`.

Its studio lights (`studiolights/matcap/*.exr`) name channels `diffuse.R` and so on; what it saves itself may put a
layer's name before that (`View Layer.diffuse.R`), and its Composite pass beside. Both halves are linear light, row 0 on
top, the disc inscribed; their sum is the MatCap. A file without such passes is one picture, which Blender takes for
diffuse.
"""

from pathlib import Path

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from litrig.base.pictures import LARGEST_PIXELS, write_exr
from litrig.base.quiet import quiet_library

F32 = NDArray[np.float32]

PASSES = ("diffuse", "specular")
LARGEST = float(np.finfo(np.float16).max)


def is_blender_matcap(path: Path) -> bool:
    """Tell from its channels whether a file is an EXR with both passes; one that cannot be read is none."""
    if path.suffix.lower() != ".exr":
        return False
    try:
        with quiet_library(), OpenEXR.File(str(path), header_only=True) as exr:
            names = [channel.name for part in exr.parts for channel in part.header["channels"]]
    except (RuntimeError, ValueError, OSError, LookupError, TypeError):
        return False
    return all(any(_pass_of(name) == (wanted, "R") for name in names) for wanted in PASSES)


def read_blender_matcap(path: Path) -> tuple[F32, F32]:
    """Read the two halves of a Blender MatCap.

    Returns
    -------
    diffuse, specular : (H, W, 3) float32, linear light

    Raises
    ------
    InputError, FormatError
        The file is missing, damaged, lacks a pass or a colour, or holds what are no numbers.
    """
    if not path.exists():
        raise InputError(f"{path}: no such file; check the path")
    try:
        with quiet_library(), OpenEXR.File(str(path), header_only=True) as exr:
            for part in exr.parts:
                (left, top), (right, bottom) = (corner.tolist() for corner in part.header["dataWindow"])
                if not 0 < (right - left + 1) * (bottom - top + 1) <= LARGEST_PIXELS:
                    raise FormatError(f"{path}: claims more than {LARGEST_PIXELS:,} pixels; refused")
        with quiet_library(), OpenEXR.File(str(path), separate_channels=True) as exr:
            planes = {
                _pass_of(name): np.asarray(channel.pixels)
                for part in exr.parts
                for name, channel in part.channels.items()
            }
    except (RuntimeError, ValueError, OSError, LookupError, TypeError) as error:
        raise FormatError(f"{path}: damaged EXR ({error}); copy or render it again") from error
    diffuse, specular = (_picture(path, planes, wanted) for wanted in PASSES)
    if diffuse.shape != specular.shape:
        raise FormatError(f"{path}: its passes differ in size; render it again")
    return diffuse, specular


def write_blender_matcap(path: Path, diffuse: F32, specular: F32) -> None:
    """Write the two halves (H, W, 3) each, linear light, as half floats; the file is whole or not there.

    Raises
    ------
    InputError
        The name does not end in .exr, a half is brighter than any file holds, or the file cannot be written.
    """
    if path.suffix.lower() != ".exr":
        raise InputError(f"{path}: cannot hold a Blender MatCap; end the name in .exr")
    if not (np.all(np.isfinite(diffuse)) and np.all(np.isfinite(specular))):
        raise InputError(f"{path}: the ball is brighter than files can hold; lessen gains, colours and lights")
    channels = {
        f"{name}.{colour}": np.ascontiguousarray(np.clip(picture[..., number], -LARGEST, LARGEST), np.float16)
        for name, picture in zip(PASSES, (diffuse, specular), strict=True)
        for number, colour in enumerate("RGB")
    }
    write_exr(path, channels, {"litrig.kind": "matcap-blender"})


def _pass_of(channel: str) -> tuple[str, str]:
    """Return a channel's pass and colour, as Blender parses its name from the end; the layer does not matter."""
    words = channel.split(".")
    return (words[-2] if len(words) > 1 else "", words[-1].upper())


def _picture(path: Path, planes: dict[tuple[str, str], NDArray[np.generic]], wanted: str) -> F32:
    lacking = [colour for colour in "RGB" if (wanted, colour) not in planes]
    if lacking:
        raise FormatError(f"{path}: lacks channel {wanted}.{lacking[0]}; give a MatCap as Blender has it")
    picture = np.stack([planes[wanted, colour] for colour in "RGB"], axis=-1).astype(np.float32)
    if not np.all(np.isfinite(picture)):
        raise FormatError(f"{path}: pass {wanted} holds values that are no numbers; render it again")
    return picture
