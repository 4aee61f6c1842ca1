"""A decomposed MatCap on the graphics card: two dual paraboloid maps whose light adds up."""

from collections.abc import Mapping

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.matcap.model import DecomposedMatcap
from viewer.gl_context import GlContext
from viewer.look import Look, Texture, UniformValue
from viewer.materials.amc import TABLE_NORMAL_CODES

F32 = NDArray[np.float32]


class DecomposedMatcapMaterial:
    """Four maps, with smaller copies. Slopes and base colours are told with every draw, so that they can be edited."""

    def __init__(self, gl: GlContext, matcap: DecomposedMatcap) -> None:
        """Upload.

        Raises
        ------
        InputError
            The maps are larger than the card takes, not square, or hold what are no numbers.
        """
        self._matcap = matcap
        low, high = matcap.low, matcap.high
        maps = {"low_front": low.front, "low_back": low.back, "high_front": high.front, "high_back": high.back}
        self._textures = upload_maps(gl, "MatCap", maps)
        self.level_count = low.front.shape[0].bit_length()

    def look(self, *, level: int | None = None, occluded: bool = False) -> Look:
        """Say how it is drawn (the MatCap paper, section 5).

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        occluded : darken by the mesh's ambient occlusion

        Raises
        ------
        InputError
            The level does not exist.
        """
        if level is not None and not 0 <= level < self.level_count:
            raise InputError(f"MatCap: there is no mip level {level}; there are 0 to {self.level_count - 1}")
        low, high = self._matcap.low, self._matcap.high
        uniforms: dict[str, UniformValue] = {
            "low_colour": low.base_colour,
            "high_colour": high.base_colour,
            "slopes": (low.slope, high.slope),
            "table_normal": TABLE_NORMAL_CODES[self._matcap.table_normal],
            "level": -1.0 if level is None else float(level),
            "occluded": occluded,
        }
        return Look("matcap_decomposed.frag", uniforms, self._textures)

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()


def upload_maps(gl: GlContext, what: str, maps: Mapping[str, F32]) -> dict[str, Texture]:
    """Upload square maps (S, S, 3) with smaller copies; `what` names them in errors.

    Raises
    ------
    InputError
        One is larger than the card takes, not square, or holds what are no numbers.
    """
    largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
    for texels in maps.values():
        if texels.ndim != 3 or texels.shape[0] != texels.shape[1] or texels.shape[2] != 3 or not texels.size:
            raise InputError(f"{what}: an array {texels.shape} is no square map; give (S, S, 3)")
        if texels.shape[0] > largest:
            raise InputError(
                f"{what}: maps of {texels.shape[1]} × {texels.shape[0]} texels, but this graphics driver ends at "
                f"{largest}; shrink them"
            )
        if not np.all(np.isfinite(texels)):
            raise InputError(f"{what}: a map holds colours that are no numbers; mend it")
    textures: dict[str, Texture] = {}
    for name, texels in maps.items():
        size = (texels.shape[1], texels.shape[0])
        texture = gl.moderngl.texture(size, 3, np.ascontiguousarray(texels, "<f4").tobytes(), alignment=1, dtype="f4")
        texture.repeat_x = texture.repeat_y = False
        texture.build_mipmaps()
        texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        textures[name] = texture
    return textures
