"""An AMC on the graphics card."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.amc.mips import MipLevel
from viewer.gl_calls import upload_volume_levels
from viewer.gl_context import GlContext

F16 = NDArray[np.float16]
_LARGEST_HALF = float(np.finfo(np.float16).max)


def upload_amc(context: GlContext, levels: Sequence[MipLevel]) -> moderngl.Texture3D:
    """Upload the levels of an AMC as linear half floats, whatever its file holds, so that filtering is linear.

    The levels are uploaded as they are: the card's own averaging weighs neither validity nor odd depths rightly.
    Reading clamps in columns and rows and goes round along k.

    Raises
    ------
    InputError
        The table is larger than the card takes, or brighter than half floats go.
    """
    depth, size = levels[0].coverage.shape[:2]
    largest = int(context.moderngl.info["GL_MAX_3D_TEXTURE_SIZE"])
    if max(size, depth) > largest:
        raise InputError(
            f"AMC: {size} × {size} × {depth} texels, but this graphics driver ends at {largest}; shrink it"
        )
    texels = [_halves(level) for level in levels]
    texture = context.moderngl.texture3d((size, size, depth), 4, dtype="f2")
    upload_volume_levels(context.backend, texture.glo, texels)
    smaller = moderngl.LINEAR_MIPMAP_LINEAR if len(levels) > 1 else moderngl.LINEAR
    texture.filter = (smaller, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    texture.repeat_z = True
    return texture


def _halves(level: MipLevel) -> F16:
    if not np.all(np.abs(level.colours) <= _LARGEST_HALF):
        raise InputError(f"AMC: holds colours beyond {_LARGEST_HALF:g} or no numbers at all; scale or mend it")
    return np.concatenate([level.colours, level.coverage[..., None]], axis=-1).astype(np.float16)
