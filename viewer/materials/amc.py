"""Anisotropic MatCaps on the graphics card: one table, two that add up, or two between which the key light chooses."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.mips import MipLevel, mip_chain
from processing.amc.model import Amc, TangentAngle
from processing.mesh.model import Mesh
from viewer.geometry import mesh_geometry
from viewer.gl_calls import upload_levels
from viewer.gl_context import GlContext
from viewer.key_shadow import KeyShadow
from viewer.look import Look, Texture, UniformValue
from viewer.renderer import Renderer, Size
from viewer.view import View

F16 = NDArray[np.float16]
F32 = NDArray[np.float32]
_LARGEST_HALF = float(np.finfo(np.float16).max)
TABLE_NORMAL_CODES = {TableNormal.RECTIFIED: 0, TableNormal.VIEW: 1, TableNormal.CAMERA: 2}


class Coordinates(StrEnum):
    """Where the table's coordinates i, j and k are found (the AMC paper, section 6)."""

    FRAGMENT = "fragment"
    """At every pixel, from the interpolated normal and tangent."""
    MIXED = "mixed"
    """i and j at every pixel, k at the vertices: the paper's more accurate way."""
    VERTEX = "vertex"
    """At the vertices: the paper's quick way; facets show on coarse meshes."""


_SHADERS = {
    Coordinates.FRAGMENT: ("mesh.vert", "amc.frag", frozenset[str]()),
    Coordinates.MIXED: ("amc.vert", "amc_vertex.frag", frozenset[str]()),
    Coordinates.VERTEX: ("amc.vert", "amc_vertex.frag", frozenset({"PLACE_PER_VERTEX"})),
}


class AmcMaterial:
    """A table of pre-lit colour over normal and tangent direction, as a volume (the AMC paper, section 6)."""

    def __init__(self, gl: GlContext, amc: Amc, levels: Sequence[MipLevel] | None = None) -> None:
        """Upload.

        Parameters
        ----------
        levels : the mip levels that the AMC's file has; None makes them

        Raises
        ------
        InputError
            The table is larger than the card takes, or brighter than half floats go.
        """
        chain = mip_chain(amc) if levels is None else list(levels)
        self.level_count = len(chain)
        self.shape = amc.slices.shape
        self.meaning = meaning_of(amc)
        self.table = _upload_table(gl, chain)

    def look(
        self,
        *,
        level: int | None = None,
        seam_trick: bool = True,
        coordinates: Coordinates = Coordinates.FRAGMENT,
        occluded: bool = False,
    ) -> Look:
        """Say how it is drawn.

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        seam_trick : choose between k and k′ by what changes less (section 6.2); off shows the seam that it removes
        coordinates : where i, j and k are found
        occluded : darken by the mesh's ambient occlusion (section 6.1)

        Raises
        ------
        InputError
            The level does not exist.
        """
        vertex, fragment, switches = _SHADERS[coordinates]
        uniforms = {**told("meaning", self.meaning), **self._reading(level, seam_trick, occluded)}
        return Look(fragment, uniforms, {"table": self.table}, vertex, switches)

    def look_with(
        self, other: "AmcMaterial", *, level: int | None = None, seam_trick: bool = True, occluded: bool = False
    ) -> Look:
        """Say how the sum of two tables is drawn, each with its own table normal: a split AMC's low and high part."""
        uniforms = {
            **told("meaning", self.meaning),
            **told("other_meaning", other.meaning),
            **self._reading(level, seam_trick, occluded),
        }
        return Look("amc_sum.frag", uniforms, {"table": self.table, "other_table": other.table})

    def keyed_look(
        self,
        unlit: "AmcMaterial",
        shadow: KeyShadow,
        *,
        level: int | None = None,
        seam_trick: bool = True,
        occluded: bool = False,
    ) -> Look:
        """Say how it is drawn with another table where the key light is in shadow (section 6.1).

        Parameters
        ----------
        unlit : captured without the key light
        shadow : cast by the same geometry in the same view

        Raises
        ------
        InputError
            The two tables are not of one form.
        """
        if self.shape != unlit.shape or self.meaning != unlit.meaning:
            raise InputError(
                "AMC: the tables with and without the key light differ in size, R or table normal; "
                "build both at once with litrig amc build --unlit"
            )
        uniforms = {
            **told("meaning", self.meaning),
            **shadow.uniforms,
            **self._reading(level, seam_trick, occluded),
        }
        textures: dict[str, Texture] = {"table": self.table, "unlit_table": unlit.table, "key_depth": shadow.depth}
        return Look("amc_keyed.frag", uniforms, textures)

    def release(self) -> None:
        self.table.release()

    def _reading(self, level: int | None, seam_trick: bool, occluded: bool) -> dict[str, UniformValue]:
        return reading(level, self.level_count, seam_trick, occluded)


def amc_picture(
    renderer: Renderer,
    amc: Amc,
    mesh: Mesh,
    view: View,
    *,
    size: Size,
    levels: Sequence[MipLevel] | None = None,
    level: int | None = None,
    supersample: int = 1,
    seam_trick: bool = True,
    coordinates: Coordinates = Coordinates.FRAGMENT,
    occluded: bool = False,
) -> F32:
    """Draw a mesh made of the material once: `AmcMaterial` and `AmcMaterial.look` in one.

    Returns
    -------
    picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top
    """
    with renderer.upload(AmcMaterial, amc, levels) as material, renderer.upload(mesh_geometry, mesh) as geometry:
        look = material.look(level=level, seam_trick=seam_trick, coordinates=coordinates, occluded=occluded)
        return renderer.picture(look, geometry, view, size=size, supersample=supersample)


def meaning_of(amc: Amc) -> dict[str, UniformValue]:
    """Tell a shader how a table's places are to be understood (`Meaning` in amc_place.glsl)."""
    return {
        "table_normal": TABLE_NORMAL_CODES[amc.table_normal],
        "angle_in_surface": amc.tangent_angle is TangentAngle.SURFACE,
        "repeats": float(amc.repeats),
        "first_slice": 0.5 / len(amc.slices),
    }


def told(name: str, members: Mapping[str, UniformValue]) -> dict[str, UniformValue]:
    """Name the members of a structure as OpenGL does."""
    return {f"{name}.{member}": value for member, value in members.items()}


def reading(level: int | None, level_count: int, seam_trick: bool, occluded: bool) -> dict[str, UniformValue]:
    """Tell a shader how to read (`amc_read.glsl`).

    Raises
    ------
    InputError
        The level does not exist.
    """
    if level is not None and not 0 <= level < level_count:
        raise InputError(f"AMC: has mip levels 0 to {level_count - 1}, not {level}")
    return {"level": -1.0 if level is None else float(level), "seam_trick": seam_trick, "occluded": occluded}


def _upload_table(gl: GlContext, levels: Sequence[MipLevel]) -> moderngl.Texture3D:
    """Upload the levels of an AMC as linear half floats, whatever its file holds, so that filtering is linear.

    The levels are uploaded as they are: the card's own averaging weighs neither validity nor odd depths rightly.
    Reading clamps in columns and rows and goes round along k.
    """
    depth, size = levels[0].coverage.shape[:2]
    largest = int(gl.moderngl.info["GL_MAX_3D_TEXTURE_SIZE"])
    if max(size, depth) > largest:
        raise InputError(
            f"AMC: {size} × {size} × {depth} texels, but this graphics driver ends at {largest}; shrink it"
        )
    texels = [_halves(level) for level in levels]
    texture = gl.moderngl.texture3d((size, size, depth), 4, dtype="f2")
    upload_levels(gl.backend, texture, texels)
    smaller = moderngl.LINEAR_MIPMAP_LINEAR if len(levels) > 1 else moderngl.LINEAR
    texture.filter = (smaller, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    texture.repeat_z = True
    return texture


def _halves(level: MipLevel) -> F16:
    if not np.all(np.abs(level.colours) <= _LARGEST_HALF):
        raise InputError(f"AMC: holds colours beyond {_LARGEST_HALF:g} or no numbers at all; scale or mend it")
    return np.concatenate([level.colours, level.coverage[..., None]], axis=-1).astype(np.float16)
