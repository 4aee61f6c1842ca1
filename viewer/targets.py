"""What is drawn into: a float picture with depth, finer than asked where edges shall be smooth."""

from typing import Protocol

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from viewer.errors import GraphicsError
from viewer.gl_context import GlContext

F32 = NDArray[np.float32]


class Drawable(Protocol):
    """What can be drawn into."""

    size: tuple[int, int]
    framebuffer: moderngl.Framebuffer

    def clear(self) -> None: ...


class Target:
    """A picture on the card: linear light, not cut off at 1, and straight coverage.

    Attributes
    ----------
    size : width and height in pixels of what is read
    drawn_size : width and height in pixels of what is drawn, `supersample` times finer
    colour : the texture, RGBA float32, to be shown without reading it; its first row is the lowest of the picture
    framebuffer : what OpenGL draws into
    """

    def __init__(self, gl: GlContext, size: tuple[int, int], supersample: int = 1) -> None:
        """Make a picture that is clear all over.

        Raises
        ------
        InputError
            The size is not one that the graphics driver can draw, or the supersampling is below 1.
        GraphicsError
            The graphics driver has no room for it.
        """
        if supersample < 1:
            raise InputError(f"picture: supersampling {supersample} is below 1; 1 is off, 3 is smooth")
        self._gl = gl
        self.size, self.supersample = size, supersample
        self.drawn_size = (size[0] * supersample, size[1] * supersample)
        check_size(gl, self.drawn_size)
        context = gl.moderngl
        parts: list[moderngl.Texture | moderngl.Renderbuffer | moderngl.Framebuffer] = []
        try:
            self.colour = context.texture(self.drawn_size, 4, dtype="f4")
            parts.append(self.colour)
            depth = context.depth_renderbuffer(self.drawn_size)
            parts.append(depth)
            self.framebuffer = context.framebuffer([self.colour], depth)
            parts.append(self.framebuffer)
        except moderngl.Error as error:
            for part in parts:
                part.release()
            raise GraphicsError(
                f"picture: the graphics driver has no room for {self.drawn_size[0]} × {self.drawn_size[1]} pixels "
                f"({error}); ask for a smaller picture"
            ) from error
        self._parts = parts[::-1]
        self.clear()

    def clear(self) -> None:
        """Take away what was drawn, in the current context."""
        self.framebuffer.clear(0.0, 0.0, 0.0, 0.0, 1.0)

    def read(self) -> F32:
        """Read the picture, (H, W, 4) float32 with row 0 on top, averaged to `size`."""
        with self._gl.moderngl:
            rows = read_rows(self.framebuffer)
            check_errors(self._gl.moderngl, "picture")
        return average_down(rows[::-1], self.supersample)

    def release(self) -> None:
        for part in self._parts:
            part.release()
        self._parts = []


class DepthTarget:
    """The depth of the nearest surface at every texel, and nothing else: a shadow map.

    Attributes
    ----------
    size : width and height in texels
    depth : the texture, 0 to 1; a shader's sampler2DShadow tells if a depth is nearer, and between texels how much
    """

    def __init__(self, gl: GlContext, size: tuple[int, int]) -> None:
        """Make a map on which nothing stands yet.

        Raises
        ------
        InputError
            The size is not one that the graphics driver can draw.
        """
        check_size(gl, size)
        self.size = size
        self.depth = gl.moderngl.depth_texture(size)
        self.depth.compare_func = "<="
        self.depth.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.depth.repeat_x = self.depth.repeat_y = False
        self.framebuffer = gl.moderngl.framebuffer(depth_attachment=self.depth)
        self.clear()

    def clear(self) -> None:
        self.framebuffer.clear(depth=1.0)

    def release(self) -> None:
        self.framebuffer.release()
        self.depth.release()


def check_size(gl: GlContext, size: tuple[int, int]) -> None:
    """Refuse a picture that the graphics driver cannot draw.

    Raises
    ------
    InputError
        It cannot.
    """
    width, height = size
    largest = int(gl.moderngl.info["GL_MAX_RENDERBUFFER_SIZE"])
    if not (1 <= width <= largest and 1 <= height <= largest):
        raise InputError(f"picture: {width} × {height} pixels are outside 1..{largest} of this graphics driver")


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
