"""A plain MatCap on the graphics card: colour over the normal alone."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.mips import mip_chain
from processing.amc.model import Amc
from processing.amc.resample import dilate
from viewer.gl_context import GlContext
from viewer.look import Look, UniformValue
from viewer.materials.amc import TABLE_NORMAL_CODES, reading

F32 = NDArray[np.float32]


class MatcapMaterial:
    """The picture of a ball, its disc inscribed in the square."""

    def __init__(self, gl: GlContext, disc: F32, table_normal: TableNormal = TableNormal.RECTIFIED) -> None:
        """Upload it with its smaller copies, which keep the disc's surroundings out.

        Parameters
        ----------
        disc : (S, S, 3) float32, linear light, row 0 at n_y = +1; what lies outside the disc is no data
        table_normal : how a perspective picture's normal is brought to the disc

        Raises
        ------
        InputError
            The disc is no square, no numbers, or larger than the card takes.
        """
        largest = int(gl.moderngl.info["GL_MAX_TEXTURE_SIZE"])
        if disc.ndim != 3 or disc.shape[0] != disc.shape[1] or disc.shape[2] != 3 or not disc.size:
            raise InputError(f"MatCap: an array {disc.shape} is no square picture; crop it to the ball")
        if disc.shape[0] > largest:
            raise InputError(
                f"MatCap: {disc.shape[1]} × {disc.shape[0]} texels, but this graphics driver ends at {largest}; "
                "shrink it"
            )
        if not np.all(np.isfinite(disc)):
            raise InputError("MatCap: holds colours that are no numbers; mend it")
        self._table_normal = TABLE_NORMAL_CODES[table_normal]
        levels = mip_chain(plain_table(disc))
        size = disc.shape[0]
        self._level_count = len(levels)
        self._disc = gl.moderngl.texture((size, size), 3, dtype="f4")
        self._disc.build_mipmaps()
        for number, level in enumerate(levels):
            self._disc.write(np.ascontiguousarray(level.colours[0], "<f4").tobytes(), level=number, alignment=1)
        self._disc.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        self._disc.repeat_x = self._disc.repeat_y = False

    def look(self, *, level: int | None = None, occluded: bool = False) -> Look:
        """Say how it is drawn.

        Parameters
        ----------
        level : read this mip level everywhere; None reads the one that fits the surface's size on screen
        occluded : darken by the mesh's ambient occlusion

        Raises
        ------
        InputError
            The level does not exist.
        """
        told = reading(level, self._level_count, seam_trick=False, occluded=occluded)
        uniforms: dict[str, UniformValue] = {
            "table_normal": self._table_normal,
            "level": told["level"],
            "occluded": occluded,
        }
        return Look("matcap.frag", uniforms, {"disc": self._disc})

    def release(self) -> None:
        self._disc.release()


def plain_table(disc: F32, table_normal: TableNormal = TableNormal.RECTIFIED) -> Amc:
    """Understand a disc (S, S, 3) as an AMC of one slice, with what lies outside the disc filled from its rim."""
    size = disc.shape[0]
    along = (2 * np.arange(size) + 1) / size - 1
    valid: NDArray[np.bool_] = np.hypot(along[:, None], along[None, :]) < 1
    return Amc(dilate(disc[None].astype(np.float32), valid), valid[None], "isotropic", table_normal)
