"""Pictures that are hung into the light, with what they cover."""

from pathlib import Path

import cv2
import numpy as np
import OpenEXR
from numpy.typing import NDArray

from litrig.base.pictures import read_linear
from litrig.base.quiet import quiet_library

F32 = NDArray[np.float32]


def read_with_coverage(path: Path) -> F32:
    """Read a picture (H, W, 4) float32: linear light, and coverage 0..1 from a PNG's or EXR's alpha, else 1.

    Raises
    ------
    InputError, FormatError
        The file is missing, of an unknown format, or damaged.
    """
    light = read_linear(path)  # which says what is wrong with the file
    coverage = _coverage(path)
    whole = np.ones(light.shape[:2], np.float32) if coverage is None else np.clip(coverage, 0, 1)
    return np.concatenate([light, whole[..., None]], axis=-1, dtype=np.float32)


def _coverage(path: Path) -> F32 | None:
    match path.suffix.lower():
        case ".png":
            codes = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
            if codes is None or codes.ndim != 3 or codes.shape[2] != 4:
                return None
            most = 255 if codes.dtype == np.uint8 else 65535
            return np.asarray(codes[..., 3], np.float32) / np.float32(most)
        case ".exr":
            with quiet_library(), OpenEXR.File(str(path)) as exr:
                channels = exr.channels()
                return np.asarray(channels["RGBA"].pixels[..., 3], np.float32) if "RGBA" in channels else None
        case _:
            return None
