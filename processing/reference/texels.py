"""Reading planes of texels between their centres, in plain NumPy and double precision."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Floats = NDArray[np.floating]


def bilinear(plane: Floats, columns: Floats, rows: Floats) -> F64:
    """Read a plane (H, W, ...) at places in texture coordinates, 0 to 1 from the first texel's edge to the last's.

    Beyond the centres of the outermost texels, these are repeated.

    Returns
    -------
    values : (N, ...) float64
    """
    height, width = plane.shape[:2]
    x = np.clip(columns * width - 0.5, 0, width - 1)
    y = np.clip(rows * height - 0.5, 0, height - 1)
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    right, bottom = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    along, down = (share.reshape(-1, *[1] * (plane.ndim - 2)) for share in (x - left, y - top))
    texels = plane.astype(np.float64)
    above = texels[top, left] * (1 - along) + texels[top, right] * along
    below = texels[bottom, left] * (1 - along) + texels[bottom, right] * along
    values: F64 = above * (1 - down) + below * down
    return values
