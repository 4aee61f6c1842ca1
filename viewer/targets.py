"""What is drawn into: a float picture with depth, finer than asked where edges shall be smooth."""

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from viewer.errors import GraphicsError

F32 = NDArray[np.float32]


@contextmanager
def target(context: moderngl.Context, size: tuple[int, int]) -> Iterator[moderngl.Framebuffer]:
    """Make a float picture with depth, draw into it, and let it go.

    Raises
    ------
    InputError
        The size is not one that the graphics driver can draw.
    """
    width, height = size
    largest = int(context.info["GL_MAX_RENDERBUFFER_SIZE"])
    if not (1 <= width <= largest and 1 <= height <= largest):
        raise InputError(f"picture: {width} × {height} pixels are outside 1..{largest} of this graphics driver")
    previous = context.detect_framebuffer()
    colour = context.texture(size, 4, dtype="f4")
    depth = context.depth_renderbuffer(size)
    framebuffer = context.framebuffer([colour], depth)
    try:
        framebuffer.use()
        framebuffer.clear(0.0, 0.0, 0.0, 0.0, 1.0)
        yield framebuffer
    finally:
        # A framebuffer that is let go while bound makes the next one's creation fail.
        previous.use()
        for part in (framebuffer, colour, depth):
            part.release()


def read_rows(framebuffer: moderngl.Framebuffer) -> F32:
    """Read (H, W, 4) float32, in OpenGL's order: the bottom row first."""
    width, height = framebuffer.size
    return np.frombuffer(framebuffer.read(components=4, dtype="f4"), np.float32).reshape(height, width, 4)


def average_down(picture: F32, times: int) -> F32:
    """Average blocks of `times`² pixels, colours weighted by coverage, (H, W, 4) straight alpha in and out."""
    height, width = picture.shape[0] // times, picture.shape[1] // times
    blocks = picture.reshape(height, times, width, times, 4)
    coverage = blocks[..., 3:].mean(axis=(1, 3))
    weighted = (blocks[..., :3] * blocks[..., 3:]).mean(axis=(1, 3))
    colours = weighted / np.where(coverage > 0, coverage, 1)
    return np.concatenate([colours, coverage], axis=-1)


def check_errors(context: moderngl.Context, doing: str) -> None:
    """Raise what the graphics driver complained about since it was last asked.

    Raises
    ------
    GraphicsError
        It did.
    """
    word = context.error
    if word != "GL_NO_ERROR":
        raise GraphicsError(
            f"{doing}: the graphics driver reports {word}; ask for a smaller picture or update the driver"
        )
