"""A PTM on the graphics card, and the pictures that it makes: flat, or laid on a mesh."""

import math

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from processing.ptm.relighting.normals import normals_of
from viewer.geometry import mesh_geometry, whole_picture
from viewer.gl_context import GlContext
from viewer.look import Look, Texture, UniformValue
from viewer.renderer import Renderer, Size
from viewer.view import View

F32 = NDArray[np.float32]
Light = tuple[float, float]
BAND_TEXELS = 4 << 20
"""A flat PTM is drawn in bands of rows of about so many texels, so that large ones need little memory."""


class PtmMaterial:
    """Six layers of coefficients, and the colour of the luminance, float32 as in the model; row 0 first."""

    def __init__(
        self, gl: GlContext, ptm: Ptm, *, smooth: bool = False, normals: F32 | None = None, repeat: int = 1
    ) -> None:
        """Upload.

        Parameters
        ----------
        smooth : interpolate, and make smaller copies, for a surface that is seen at any size; coefficients are linear
        normals : (H, W, 3) unit, in the picture's frame, for a highlight
        repeat : how often a surface shows it across its texture coordinates, each way

        Raises
        ------
        InputError
            It is larger than the card takes.
        """
        _, height, width, channels = ptm.coefficients.shape
        largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
        if max(width, height) > largest:
            raise InputError(
                f"PTM: {width} × {height} texels, but this graphics driver ends at {largest}; cut or shrink it"
            )
        self._is_luminance, self._is_display = ptm.colour is not None, ptm.space == "srgb"
        colour = np.ones((1, 1, 3), np.float32) if ptm.colour is None else ptm.colour
        self._layers = gl.moderngl.texture_array(
            (width, height, 6), channels, _bytes(ptm.coefficients), alignment=1, dtype="f4"
        )
        self._factor = gl.moderngl.texture(
            (colour.shape[1], colour.shape[0]), 3, _bytes(colour), alignment=1, dtype="f4"
        )
        self._repeat = repeat
        self._normals = None
        if normals is not None:
            self._normals = gl.moderngl.texture((width, height), 3, _bytes(normals), alignment=1, dtype="f4")
        self._all = [texture for texture in (self._layers, self._factor, self._normals) if texture is not None]
        for texture in self._all:
            texture.repeat_x = texture.repeat_y = repeat > 1
            if smooth:
                texture.build_mipmaps()
                texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)

    def flat_look(self, light: Light) -> Look:
        """Relight it as the picture that it is, texel by texel; draw it on `whole_picture` at its own size.

        Row 0 is drawn at the bottom.

        Parameters
        ----------
        light : x and y of the unit vector to the light, view frame

        Raises
        ------
        InputError
            The light is outside the unit disc.
        """
        _light_z(light)
        uniforms: dict[str, UniformValue] = {"is_luminance": self._is_luminance, "light": light}
        return Look("ptm_flat.frag", uniforms, self._textures(), vertex="flat.vert")

    def mesh_look(
        self,
        light: Light,
        *,
        occluded: bool = False,
        highlight: tuple[float, float] | None = None,
    ) -> Look:
        """Lay it on a mesh and light it from one direction of the view frame; no shadows are cast.

        Parameters
        ----------
        occluded : darken by the mesh's ambient occlusion
        highlight : ks, where 1 is white, and exponent of ks·(m·h)^exponent, which is added to the stored values
            (Synthesis and Rendering of 3D Textures, section II); m is the normal of the texel, h half-way between light
            and eye. The material must have been given normals

        Raises
        ------
        InputError
            The light is outside the unit disc.
        """
        uniforms: dict[str, UniformValue] = {
            "is_luminance": self._is_luminance,
            "light_direction": (*light, _light_z(light)),
            "is_display": self._is_display,
            "occluded": occluded,
            "repeat": float(self._repeat),
        }
        if highlight is None:
            return Look("ptm_mesh.frag", uniforms, self._textures())
        if self._normals is None:
            raise ValueError("a highlight needs the normals that the material was uploaded without")
        uniforms["highlight"] = highlight
        textures = {**self._textures(), "texel_normals": self._normals}
        return Look("ptm_mesh.frag", uniforms, textures, switches=frozenset({"HIGHLIGHT"}))

    def release(self) -> None:
        for texture in self._all:
            texture.release()

    def _textures(self) -> dict[str, Texture]:
        return {"coefficients": self._layers, "luminance_colour": self._factor}


def ptm_picture(renderer: Renderer, ptm: Ptm, light: Light) -> F32:
    """Relight a PTM flat, at its own size, which may be higher than the graphics driver's pictures.

    Returns
    -------
    values : (H, W, 3) float32 in the PTM's own space, where 1 is white; not cut off. Row 0 on top

    Raises
    ------
    InputError
        The light is outside the unit disc, or the PTM is wider than the graphics driver takes.
    GraphicsError
        The graphics driver failed.
    """
    height, width = ptm.coefficients.shape[1:3]
    rows = max(1, BAND_TEXELS // width)
    bands = [_rows(ptm, start, start + rows) for start in range(0, height, rows)]
    return np.concatenate([_band_picture(renderer, band, light) for band in bands])


def ptm_mesh_picture(
    renderer: Renderer,
    ptm: Ptm,
    mesh: Mesh,
    view: View,
    light: Light,
    *,
    size: Size,
    supersample: int = 1,
    highlight: tuple[float, float] | None = None,
    repeat: int = 1,
) -> F32:
    """Draw a PTM on a mesh once: `PtmMaterial` and `PtmMaterial.mesh_look` in one, normals of the PTM's own.

    Returns
    -------
    picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top
    """
    normals = None if highlight is None else normals_of(ptm)
    with (
        renderer.upload(PtmMaterial, ptm, smooth=True, normals=normals, repeat=repeat) as material,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        look = material.mesh_look(light, highlight=highlight)
        return renderer.picture(look, geometry, view, size=size, supersample=supersample)


def _band_picture(renderer: Renderer, band: Ptm, light: Light) -> F32:
    size = (band.coefficients.shape[2], band.coefficients.shape[1])
    with renderer.upload(PtmMaterial, band) as material, renderer.upload(whole_picture) as everything:
        # Row 0 was drawn at the bottom.
        return renderer.picture(material.flat_look(light), everything, size=size)[::-1, :, :3]


def _light_z(light: Light) -> float:
    square = light[0] ** 2 + light[1] ** 2
    if not square <= 1:
        raise InputError(
            f"light: ({light[0]:g}, {light[1]:g}) is no direction; give x and y of a unit vector, x² + y² ≤ 1"
        )
    return math.sqrt(1 - square)


def _rows(ptm: Ptm, start: int, end: int) -> Ptm:
    colour = None if ptm.colour is None else ptm.colour[start:end]
    return Ptm(ptm.coefficients[:, start:end], colour, ptm.space, ptm.source)


def _bytes(values: F32) -> bytes:
    return np.ascontiguousarray(values, "<f4").tobytes()
