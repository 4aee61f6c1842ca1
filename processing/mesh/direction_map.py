"""Painted directions from a picture file: red is x, green is y, and 0.5 is none.

So does glTF's KHR_materials_anisotropy store them. The values are plain numbers, not colours: no sRGB curve is taken
off a PNG. JPEG is refused, for it keeps a quarter of the pixels of what it takes for colour.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear

F32 = NDArray[np.float32]
_CODED = frozenset({".png", ".tif", ".tiff"})


def read_directions(path: Path) -> F32:
    """Read a direction map.

    Returns
    -------
    directions : (H, W, 2) float32, x to the right and y upwards in the picture, −1..1; row 0 on top

    Raises
    ------
    InputError, FormatError
        The file is missing, of another format, damaged, or holds values outside 0..1.
    """
    ending = path.suffix.lower()
    if ending in _CODED:
        codes = read_codes(path)
        values: F32 = codes[..., :2].astype(np.float32) / np.float32(np.iinfo(codes.dtype).max)
    elif ending == ".exr":
        values = read_linear(path)[..., :2]
    else:
        raise InputError(f"{path}: directions cannot be read from {ending or 'a file without ending'}; use PNG or EXR")
    if not np.all((values >= 0) & (values <= 1)):
        raise InputError(f"{path}: red and green reach beyond 0..1; store a direction as 0.5 + 0.5·x and 0.5 + 0.5·y")
    return np.float32(2) * values - np.float32(1)
