"""One map of a pair widened past its square, so that what is near a texel can be read without minding the seam."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


_RIM_TEXELS = 8


def widened(this: F32, other: F32, pad: int) -> F32:
    """Widen a map (S, S, C) by `pad` texels each way; all beyond its unit circle is read from the other map.

    The place (u, v) of one map is (u, v)/q of the other, with q = u² + v². Where the unit circle touches the square the
    other map ends half a texel too early for splines, so it is given a rim of this one's texels first.
    """
    rim = min(_RIM_TEXELS, this.shape[0] - 1)
    continued = ((rim, rim), (rim, rim), (0, 0))
    first = _beyond(other, np.pad(this, continued, mode="reflect", reflect_type="odd"), rim, rim)
    return _beyond(this, first, pad, rim)


def _beyond(this: F32, other: F32, pad: int, other_pad: int) -> F32:
    """Widen, with a map for the other side that is `other_pad` texels wider than it was."""
    size = this.shape[0]
    u, v = plane(size, pad)
    q = u * u + v * v
    beyond = q > 1
    whole = np.pad(this, ((pad, pad), (pad, pad), (0, 0)), mode="edge").astype(np.float32)
    columns, rows = ((1 + axis / q[beyond]) * size / 2 - 0.5 + other_pad for axis in (u[beyond], -v[beyond]))
    whole[beyond] = splined(other, columns, rows)
    return whole


def splined(texels: F32, columns: F64, rows: F64) -> F32:
    """Read a map (S, S, C) at places counted in texels from the first one's centre, by cubic splines: (N, C)."""
    channels = [
        map_coordinates(texels[..., channel], [rows, columns], order=3, output=np.float32, mode="nearest")
        for channel in range(texels.shape[2])
    ]
    return np.stack(channels, axis=-1)


def plane(size: int, pad: int = 0) -> tuple[F64, F64]:
    """Return (u, v) of the texel centres of a map of `size`, widened by `pad` texels each way."""
    along = (2 * np.arange(-pad, size + pad) + 1) / size - 1
    u, v = np.meshgrid(along, -along)
    return u, v


def joined(front: F32, back: F32) -> tuple[F32, F32]:
    """Return the pair with each map's corners, beyond the unit circle, read from the other map."""
    return widened(front, back, 0), widened(back, front, 0)
