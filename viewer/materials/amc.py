"""An AMC on the graphics card, and the pictures that it makes."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.mips import MipLevel, mip_chain
from processing.amc.model import Amc, TangentAngle
from processing.mesh.model import Mesh
from viewer.geometry import mesh_geometry
from viewer.gl_calls import upload_volume_levels
from viewer.gl_context import GlContext
from viewer.look import Look, UniformValue
from viewer.renderer import Renderer, Size
from viewer.view import View

F16 = NDArray[np.float16]
F32 = NDArray[np.float32]
_LARGEST_HALF = float(np.finfo(np.float16).max)
_TABLE_NORMAL_CODES = {TableNormal.RECTIFIED: 0, TableNormal.VIEW: 1, TableNormal.CAMERA: 2}


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
        self._level_count = len(chain)
        self._meaning: dict[str, UniformValue] = {
            "table_normal": _TABLE_NORMAL_CODES[amc.table_normal],
            "angle_in_surface": amc.tangent_angle is TangentAngle.SURFACE,
            "repeats": float(amc.repeats),
            "first_slice": 0.5 / len(amc.slices),
        }
        self._table = _upload_table(gl, chain)

    def look(self, *, level: int | None = None, seam_trick: bool = True) -> Look:
        """Say how it is drawn.

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        seam_trick : choose between k and k′ by what changes less (section 6.2); off shows the seam that it removes

        Raises
        ------
        InputError
            The level does not exist.
        """
        if level is not None and not 0 <= level < self._level_count:
            raise InputError(f"AMC: has mip levels 0 to {self._level_count - 1}, not {level}")
        uniforms: dict[str, UniformValue] = {
            **self._meaning,
            "level": -1.0 if level is None else float(level),
            "seam_trick": seam_trick,
        }
        return Look("amc.frag", uniforms, {"table": self._table})

    def release(self) -> None:
        self._table.release()


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
) -> F32:
    """Draw a mesh made of the material once: `AmcMaterial` and `AmcMaterial.look` in one.

    Returns
    -------
    picture : (H, W, 4) float32, linear light and straight coverage, row 0 on top
    """
    with renderer.upload(AmcMaterial, amc, levels) as material, renderer.upload(mesh_geometry, mesh) as geometry:
        look = material.look(level=level, seam_trick=seam_trick)
        return renderer.picture(look, geometry, view, size=size, supersample=supersample)


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
    upload_volume_levels(gl.backend, texture.glo, texels)
    smaller = moderngl.LINEAR_MIPMAP_LINEAR if len(levels) > 1 else moderngl.LINEAR
    texture.filter = (smaller, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    texture.repeat_z = True
    return texture


def _halves(level: MipLevel) -> F16:
    if not np.all(np.abs(level.colours) <= _LARGEST_HALF):
        raise InputError(f"AMC: holds colours beyond {_LARGEST_HALF:g} or no numbers at all; scale or mend it")
    return np.concatenate([level.colours, level.coverage[..., None]], axis=-1).astype(np.float16)
