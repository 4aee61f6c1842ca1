"""JPEGs that hold three planes of codes rather than a picture.

Coefficients are no colours: the way through Y, Cb and Cr alone costs two to three times the rounding of the JPEG
itself. The planes are stored as they are, and the Adobe marker with transform 0 says so, which every decoder honours.
Chroma is not subsampled.
"""

import struct
from pathlib import Path

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from processing.limits import FREE_BYTES, LARGEST_RATIO

U8 = NDArray[np.uint8]

LARGEST_SIDE = 65_500
_START, _JFIF = b"\xff\xd8", b"\xff\xe0"
_ADOBE = b"\xff\xee" + struct.pack(">H5sHHHB", 14, b"Adobe", 100, 0, 0, 0)


def encode_planes(planes: U8, quality: int) -> bytes:
    """Encode three planes (3, H, W), or fewer, which are repeated."""
    three = [np.ascontiguousarray(planes[min(index, len(planes) - 1)]) for index in range(3)]
    encoded = bytes(simplejpeg.encode_jpeg_yuv_planes(*three, quality=quality))
    (segment,) = struct.unpack_from(">H", encoded, 4)
    if not encoded.startswith(_START + _JFIF):
        raise RuntimeError("simplejpeg wrote no JFIF segment")
    return _START + _ADOBE + encoded[4 + segment :]


def decode_planes(path: Path, content: bytes, size: tuple[int, int], *, grey: bool = False, what: str = "") -> U8:
    """Decode a whole JPEG of a known size to (H, W, 3), or (H, W) if it is grey.

    Parameters
    ----------
    size : height and width that it must have
    what : part of the file that it stands for, in errors

    Raises
    ------
    FormatError
        It is damaged, cut short, of another size, or unpacks to very much more than it is long.
    """
    name = f"{path}: {what}" if what else f"{path}:"
    try:
        height, width, space, _ = simplejpeg.decode_jpeg_header(content)
        if (height, width) != size:
            raise FormatError(
                f"{name} is {width} × {height} pixels, where {size[1]} × {size[0]} are claimed; export it again"
            )
        if (space == "Gray") is not grey:
            wanted, found = ("grey", "colour") if grey else ("colour", "grey")
            raise FormatError(f"{name} is a {found} JPEG, not a {wanted} one; export it again")
        unpacked = height * width * (1 if grey else 3)
        if unpacked > max(FREE_BYTES, len(content) * LARGEST_RATIO):
            raise FormatError(f"{name} unpacks from {len(content):,} to {unpacked:,} bytes; refused")
        codes: U8 = simplejpeg.decode_jpeg(content, "GRAY" if grey else "RGB")
    except ValueError as error:
        raise FormatError(f"{name} is a damaged JPEG ({error}); copy or export it again") from error
    return codes[..., 0] if grey else codes


def check_side(path: Path, shape: tuple[int, int]) -> None:
    """Refuse what a JPEG cannot hold."""
    if max(shape) > LARGEST_SIDE:
        raise InputError(f"{path}: JPEGs end at {LARGEST_SIDE:,} pixels a side; write a .ptm.exr")
