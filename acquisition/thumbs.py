"""Small pictures of frames: from the folder's thumbnails, or from the frame where there is none."""

from contextlib import suppress
from pathlib import Path

import numpy as np

from litrig.base.capture_folder import layout
from litrig.base.capture_folder.writer import make_thumbnail
from litrig.base.errors import LitrigError
from litrig.base.files import read_limited, resolve_inside
from litrig.base.pictures import decode_codes
from litrig.base.radiometry import U8

LARGEST_THUMB_BYTES = 1_000_000
LARGEST_FRAME_BYTES = 1_000_000_000


def read_thumbnail(folder: Path, file: str) -> U8 | None:
    """Return a small picture (h, w, 3) uint8 RGB of a frame; None if neither it nor the frame can be read.

    Thumbnails are a convenience: nobody vouches for them, and they may be missing.

    Parameters
    ----------
    file : of the frame, as the journal names it
    """
    thumb = f"{layout.THUMBS}/{Path(file).stem}.jpg"
    for name, most_bytes in ((thumb, LARGEST_THUMB_BYTES), (file, LARGEST_FRAME_BYTES)):
        with suppress(LitrigError):
            return _small(resolve_inside(folder, name), most_bytes)
    return None


def _small(path: Path, most_bytes: int) -> U8:
    codes = decode_codes(read_limited(path, most_bytes), path.suffix.lower(), str(path))
    if codes.dtype == np.uint16:
        codes = (codes >> 8).astype(np.uint8)
    return make_thumbnail(np.asarray(codes, np.uint8))
