"""Pictures in a row as an MP4, by the ffmpeg that imageio-ffmpeg brings along."""

from collections.abc import Iterable
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.files import replacing

MACROBLOCK_PX = 2


def write_video(path: Path, frames: Iterable[NDArray[np.uint8]], fps: float = 25.0) -> None:
    """Write frames, (H, W, 3) uint8 RGB of one even size each, as H.264 that every browser plays.

    Raises
    ------
    InputError
        There is no frame, sizes differ or are odd, or the file cannot be written.
    """
    with replacing(path) as temporary:
        writer = None
        try:
            size: tuple[int, ...] = ()
            for frame in frames:
                if writer is None:
                    size = _checked(path, frame)
                    writer = imageio_ffmpeg.write_frames(
                        str(temporary), (size[1], size[0]), fps=fps, quality=7, macro_block_size=MACROBLOCK_PX
                    )
                    writer.send(None)
                if frame.shape != size:
                    raise InputError(f"{path}: frames of {frame.shape} and {size}; a video has one size")
                writer.send(np.ascontiguousarray(frame))
            if writer is None:
                raise InputError(f"{path}: a video of no frames; nothing was written")
        finally:
            if writer is not None:
                writer.close()


def _checked(path: Path, frame: NDArray[np.uint8]) -> tuple[int, ...]:
    if frame.ndim != 3 or frame.shape[2] != 3 or frame.shape[0] % MACROBLOCK_PX or frame.shape[1] % MACROBLOCK_PX:
        raise InputError(f"{path}: a frame of shape {frame.shape}; give (H, W, 3) with even height and width")
    return frame.shape
