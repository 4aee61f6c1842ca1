"""A PTM, or its kin in another basis, on the graphics card."""

from collections.abc import Mapping

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.model import Mesh
from processing.ptm.model import Ptm
from processing.ptm.relighting.brightest import brightest_light
from processing.ptm.relighting.normals import normals_of
from viewer.geometry import mesh_geometry
from viewer.gl_context import GlContext
from viewer.look import Look, Texture, UniformValue
from viewer.materials.ptm_shading import PtmShading
from viewer.renderer import Renderer, Size
from viewer.view import View

F32 = NDArray[np.float32]
_ROWS = 64


class PtmMaterial:
    """A layer of coefficients for each term, and the colour of the luminance, float32 as in the model; row 0 first.

    Normals, and the lights under which texels are brightest, are found once, where they will be wanted; they are laid
    beside the coefficients. What is drawn can then change with every frame.
    """

    def __init__(
        self,
        gl: GlContext,
        ptm: Ptm,
        *,
        smooth: bool = False,
        normals: bool = False,
        brightest: bool = False,
        repeats: bool = False,
    ) -> None:
        """Upload.

        Parameters
        ----------
        smooth : interpolate, and make smaller copies, for a surface that is seen at any size; coefficients are linear
        normals : find the normals, which highlights and the view of normals want
        brightest : find the brightest lights, which diffuse gain wants; of a polynomial of six terms
        repeats : it begins anew where it ends, as `mesh_look` may want

        Raises
        ------
        InputError
            It is larger than the card takes, or holds what are no numbers.
        """
        terms, height, width, channels = ptm.coefficients.shape
        largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
        if max(width, height) > largest:
            raise InputError(
                f"PTM: {width} × {height} texels, but this graphics driver ends at {largest}; cut or shrink it"
            )
        if not np.all(np.isfinite(ptm.coefficients)):
            raise InputError("PTM: holds coefficients that are no numbers; fit it again")
        self.ptm = ptm
        self.level_count = max(width, height).bit_length() if smooth else 1
        self._textures: dict[str, Texture] = {
            "coefficients": gl.moderngl.texture_array(
                (width, height, terms), channels, _bytes(ptm.coefficients), alignment=1, dtype="f4"
            )
        }
        planes = {"luminance_colour": ptm.colour} if ptm.colour is not None else {}
        if normals:
            planes["normals"] = normals_of(ptm)
        if brightest:
            planes["brightest"] = brightest_lights(ptm)
        for name, plane in planes.items():
            self._textures[name] = gl.moderngl.texture(
                (width, height), plane.shape[2], _bytes(plane), alignment=1, dtype="f4"
            )
        for texture in self._textures.values():
            texture.repeat_x = texture.repeat_y = repeats
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            if smooth:
                texture.build_mipmaps()
                texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)

    def flat_look(
        self,
        shading: PtmShading,
        *,
        as_light: bool = False,
        texels_a_pixel: tuple[float, float] = (1.0, 1.0),
        first_row: int = 0,
        first_texel_row: int = 0,
    ) -> Look:
        """Shade it as the picture that it is; draw it on `whole_picture`. Row 0 is drawn at the bottom.

        Parameters
        ----------
        as_light : draw linear light, in which lights add up; otherwise values in the material's own space, under the
            first light alone, whatever its colour
        texels_a_pixel : across and down. Below 1 texels are seen as squares; above, each pixel is the mean of its own
        first_row : of the picture's rows, the first that is drawn
        first_texel_row : the row of the picture's texels, at its own size, that row 0 of this material is

        Raises
        ------
        InputError
            The basis cannot be shaded so.
        """
        switches = set(self._switches(shading))
        uniforms: dict[str, UniformValue] = {
            "texels_a_pixel": texels_a_pixel,
            "first_row": first_row,
            "first_texel_row": first_texel_row,
            **shading.controls(),
        }
        if max(texels_a_pixel) > 1:
            switches.add("AVERAGED")
        if shading.view == "lit":
            if as_light:
                switches.add("AS_LIGHT")
                uniforms |= shading.light_array()
            else:
                uniforms["only_light"] = tuple(shading.lights.directions[0])
            if as_light or "AVERAGED" in switches:
                uniforms["is_display"] = self.ptm.space == "srgb"
        return Look("ptm_flat.frag", uniforms, self._wanted(shading), "flat.vert", frozenset(switches))

    def mesh_look(
        self, shading: PtmShading, *, level: int | None = None, occluded: bool = False, repeat: int = 1
    ) -> Look:
        """Lay it on a mesh; its lights are of the view frame, and cast no shadows.

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        occluded : darken by the mesh's ambient occlusion
        repeat : how often it is laid across the mesh's texture coordinates, each way

        Raises
        ------
        InputError
            The level does not exist, or the basis cannot be shaded so.
        """
        if level is not None and not 0 <= level < self.level_count:
            raise InputError(f"PTM: there is no mip level {level}; there are 0 to {self.level_count - 1}")
        uniforms: dict[str, UniformValue] = {
            "level": -1.0 if level is None else float(level),
            "occluded": occluded and shading.view == "lit",
            "repeat": float(repeat),
            **shading.controls(),
        }
        if shading.view == "lit":
            uniforms |= {"is_display": self.ptm.space == "srgb", **shading.light_array()}
        return Look("ptm_mesh.frag", uniforms, self._wanted(shading), switches=self._switches(shading))

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()

    def _switches(self, shading: PtmShading) -> frozenset[str]:
        shading.check(self.ptm.basis)
        return shading.switches(self.ptm.basis, is_luminance=self.ptm.colour is not None)

    def _wanted(self, shading: PtmShading) -> Mapping[str, Texture]:
        if shading.view == "normals":
            return {"normals": self._textures["normals"]}
        without = set() if shading.gloss is not None else {"normals"}
        if not shading.needs_brightest:
            without.add("brightest")
        return {name: texture for name, texture in self._textures.items() if name not in without}


def brightest_lights(ptm: Ptm) -> F32:
    """Find the light under which the luminance of each texel is largest, (H, W, 2): u and v."""
    found = np.zeros((*ptm.shape, 2), np.float32)
    for top in range(0, ptm.shape[0], _ROWS):
        rows = slice(top, top + _ROWS)
        found[rows] = brightest_light(ptm.coefficients[:, rows].astype(np.float64).mean(axis=-1))
    return found


def ptm_mesh_picture(
    renderer: Renderer,
    ptm: Ptm,
    mesh: Mesh,
    view: View,
    shading: PtmShading,
    *,
    size: Size,
    supersample: int = 1,
    level: int | None = None,
    occluded: bool = False,
    repeat: int = 1,
) -> F32:
    """Draw a PTM on a mesh once: `PtmMaterial` and `PtmMaterial.mesh_look` in one.

    Returns
    -------
    picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top
    """
    shading.check(ptm.basis)
    wanted = {"normals": shading.needs_normals, "brightest": shading.needs_brightest}
    with (
        renderer.upload(PtmMaterial, ptm, smooth=True, repeats=repeat > 1, **wanted) as material,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        look = material.mesh_look(shading, level=level, occluded=occluded, repeat=repeat)
        return renderer.picture(look, geometry, view, size=size, supersample=supersample)


def _bytes(values: F32) -> bytes:
    return np.ascontiguousarray(values, "<f4").tobytes()
