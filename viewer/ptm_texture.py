"""A PTM on the graphics card."""

from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.model import Ptm


@dataclass(frozen=True)
class PtmTextures:
    """Six layers of coefficients, and the colour of the luminance, float32 as in the model; row 0 first."""

    coefficients: moderngl.TextureArray
    colour: moderngl.Texture
    is_luminance: bool

    def use(self, program: moderngl.Program) -> None:
        """Bind both and tell the program where."""
        self.coefficients.use(0)
        self.colour.use(1)
        program["coefficients"] = 0
        program["luminance_colour"] = 1
        program["is_luminance"] = self.is_luminance

    def smooth(self) -> None:
        """Make smaller copies and interpolate, for a surface that is seen at any size; coefficients are linear."""
        for texture in (self.coefficients, self.colour):
            texture.build_mipmaps()
            texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)

    def release(self) -> None:
        self.coefficients.release()
        self.colour.release()


def upload_ptm(context: moderngl.Context, ptm: Ptm) -> PtmTextures:
    """Upload a PTM.

    Raises
    ------
    InputError
        It is larger than the card takes.
    """
    _, height, width, channels = ptm.coefficients.shape
    largest = int(context.info["GL_MAX_TEXTURE_SIZE"])
    if max(width, height) > largest:
        raise InputError(
            f"PTM: {width} × {height} texels, but this graphics driver ends at {largest}; cut or shrink it"
        )
    colour = np.ones((1, 1, 3), np.float32) if ptm.colour is None else ptm.colour
    layers = context.texture_array((width, height, 6), channels, _bytes(ptm.coefficients), alignment=1, dtype="f4")
    layers.repeat_x = layers.repeat_y = False
    factor = context.texture((colour.shape[1], colour.shape[0]), 3, _bytes(colour), alignment=1, dtype="f4")
    factor.repeat_x = factor.repeat_y = False
    return PtmTextures(layers, factor, ptm.colour is not None)


def _bytes(values: NDArray[np.float32]) -> bytes:
    return np.ascontiguousarray(values, "<f4").tobytes()
