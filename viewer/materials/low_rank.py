"""A low-rank AMC on the graphics card: its pictures are mixed at every pixel, and never multiplied out."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.low_rank import LowRankAmc
from processing.amc.low_rank_mips import LowRankLevel, low_rank_mip_chain
from viewer.gl_calls import upload_levels
from viewer.gl_context import GlContext
from viewer.look import Look, UniformValue
from viewer.materials.amc import meaning_of, reading, told

F32 = NDArray[np.float32]


class LowRankMaterial:
    """Basis pictures as layers, and their curves over k, four of them to a texel.

    A volume of D slices becomes as many layers as the rank, which is less memory and more reading.
    """

    def __init__(self, gl: GlContext, low_rank: LowRankAmc) -> None:
        """Upload, with smaller copies.

        Raises
        ------
        InputError
            It is larger than the card takes, or holds what are no numbers.
        """
        rank, size = low_rank.pictures.shape[:2]
        depth = len(low_rank.curves)
        info = gl.moderngl.info
        widest, most = int(info["GL_MAX_TEXTURE_SIZE"]), int(info["GL_MAX_ARRAY_TEXTURE_LAYERS"])
        if max(size, depth) > widest or rank > most:
            raise InputError(
                f"AMC: {rank} pictures of {size} × {size} texels over {depth} slices, but this graphics driver ends at "
                f"{widest} texels and {most} pictures; shrink it"
            )
        if not (np.all(np.isfinite(low_rank.pictures)) and np.all(np.isfinite(low_rank.curves))):
            raise InputError("AMC: holds colours that are no numbers; build it again")
        levels = low_rank_mip_chain(low_rank)
        self._level_count = len(levels)
        one_slice = low_rank.meaning.table(low_rank.pictures[:1], low_rank.valid[None])
        self._uniforms: dict[str, UniformValue] = {
            **told("meaning", {**meaning_of(one_slice), "first_slice": 0.5 / depth}),
            "rank": rank,
            "table_size": (float(size), float(size), float(depth)),
        }
        self._pictures = _layers(gl, [level.pictures for level in levels], 3)
        self._curves = _layers(gl, [_packed(level) for level in levels], 4)
        self._pictures.repeat_x = self._pictures.repeat_y = False
        self._curves.repeat_x, self._curves.repeat_y = True, False

    def look(self, *, level: int | None = None, seam_trick: bool = True, occluded: bool = False) -> Look:
        """Say how it is drawn; the options are those of `AmcMaterial.look`.

        Raises
        ------
        InputError
            The level does not exist.
        """
        uniforms = {**self._uniforms, **reading(level, self._level_count, seam_trick, occluded)}
        return Look("amc_low_rank.frag", uniforms, {"pictures": self._pictures, "curves": self._curves})

    def release(self) -> None:
        self._pictures.release()
        self._curves.release()


def _layers(gl: GlContext, levels: Sequence[F32], channels: int) -> moderngl.TextureArray:
    layers, height, width = levels[0].shape[:3]
    texture = gl.moderngl.texture_array((width, height, layers), channels, dtype="f4")
    upload_levels(gl.backend, texture, levels)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    return texture


def _packed(level: LowRankLevel) -> F32:
    """Lay curves (D, rank) out as texels (⌈rank/4⌉, 1, D, 4)."""
    depth, rank = level.curves.shape
    padded = np.zeros((depth, -(-rank // 4) * 4), np.float32)
    padded[:, :rank] = level.curves
    return padded.reshape(depth, 1, -1, 4).transpose(2, 1, 0, 3)
