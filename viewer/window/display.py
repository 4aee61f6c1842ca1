"""From a drawn picture to one that a window shows, without leaving the graphics card."""

import moderngl
import numpy as np

from litrig.base.radiometry import decode_srgb
from viewer.gl_context import GlContext
from viewer.look import Look
from viewer.targets import Target, check_size

Colour = tuple[float, float, float]


class DisplayTarget:
    """A picture of 8-bit display codes, opaque.

    Attributes
    ----------
    size : width and height in pixels
    colour : the texture, RGBA; its first row is the lowest of the picture
    """

    def __init__(self, gl: GlContext, size: tuple[int, int]) -> None:
        """Make a black one.

        Raises
        ------
        InputError
            The size is not one that the graphics driver can draw.
        """
        check_size(gl, size)
        self.size = size
        self.colour = gl.moderngl.texture(size, 4)
        self.colour.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.framebuffer = gl.moderngl.framebuffer([self.colour])
        self.clear()

    def clear(self) -> None:
        self.framebuffer.clear(0.0, 0.0, 0.0, 1.0)

    def release(self) -> None:
        self.framebuffer.release()
        self.colour.release()


def display_look(drawn: Target, background_srgb: Colour) -> Look:
    """Show a drawn picture over a background of display values; draw it on `whole_picture`, in `drawn.size`."""
    red, green, blue = (float(part) for part in decode_srgb(np.asarray(background_srgb)))
    return Look(
        "shown.frag",
        {"finer": drawn.supersample, "background": (red, green, blue)},
        {"drawn": drawn.colour},
        vertex="flat.vert",
    )
