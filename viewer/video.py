"""Pictures in a row as an MP4, by the ffmpeg that imageio-ffmpeg brings along."""

from collections.abc import Iterable
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.files import replacing

ENDING = ".mp4"
QUALITY = 7.0
"""0 to 10, the same for every frame whatever that takes."""
_MACROBLOCK_PX = 2
_ENCODING = [
    *("-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart"),
    "-vf",
    "scale=out_color_matrix=bt709:out_range=tv,"
    "setparams=range=tv:colorspace=bt709:color_primaries=bt709:color_trc=iec61966-2-1",
]
"""Nothing of the hour or the program goes into the file; what a browser wants to know first stands first; and the file
says what its colours are, or players would guess by its size."""


def write_video(path: Path, frames: Iterable[NDArray[np.uint8]], size: tuple[int, int], fps: float = 25.0) -> None:
    """Write frames, (H, W, 3) uint8 sRGB each, as H.264 in yuv420p, which every browser plays.

    Parameters
    ----------
    size : width and height in pixels of every frame, both even

    Raises
    ------
    InputError
        There is no frame, sizes differ or are odd, or the file cannot be written.
    """
    check_size(path, *size)
    with replacing(path) as temporary:
        writer = imageio_ffmpeg.write_frames(
            str(temporary),
            size,
            fps=fps,
            codec="libx264",
            pix_fmt_out="yuv420p",
            quality=QUALITY,
            macro_block_size=_MACROBLOCK_PX,
            output_params=_ENCODING,
        )
        count = 0
        try:
            writer.send(None)
            for frame in frames:
                if frame.shape != (size[1], size[0], 3):
                    raise InputError(f"{path}: a frame of {frame.shape} in a video of {size[0]} × {size[1]} pixels")
                writer.send(np.ascontiguousarray(frame))
                count += 1
        finally:
            writer.close()
        if not count:
            raise InputError(f"{path}: a video of no frames; nothing was written")


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse a size that yuv420p cannot hold.

    Raises
    ------
    InputError
        A side is odd, or none.
    """
    if width % _MACROBLOCK_PX or height % _MACROBLOCK_PX or min(width, height) < _MACROBLOCK_PX:
        raise InputError(f"{path}: a video of {width} × {height} pixels; both have to be even, so choose another size")


def check_video(path: Path, *, moves: bool) -> None:
    """Refuse a video in which nothing moves, and a picture in which something does.

    Raises
    ------
    InputError
        The ending and the motion do not go together, or there is no folder to write to.
    """
    is_video = path.suffix.lower() == ENDING
    if is_video and not moves:
        raise InputError(f"{path}: nothing moves in this video; say --turntable N or --tour N, or write a picture")
    if moves and not is_video:
        raise InputError(f"{path}: is no video; end the name in {ENDING}, or leave out --turntable and --tour")
    if is_video and not path.absolute().parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist; create it first")
