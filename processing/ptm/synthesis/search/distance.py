"""The distance of a block to what is known of a place (Synthesis and Rendering of 3D Textures, equation 1)."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@kernel
def squared_distances(
    texture: F32,
    guide: F32,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    values: F32,
    wanted: F32,
    known: NDArray[np.bool_],
    limit: float,
) -> F64:
    """Sum the squared differences, known pixels of the texture first, then the guide all over the block.

    Parameters
    ----------
    texture, guide : (H, W, K) and (H, W, G)
    rows, columns : (N,) upper left pixels of the candidates
    values, wanted, known : (B, B, K), (B, B, G), (B, B)
    limit : sums that grow beyond it are given up

    Returns
    -------
    distances : (N,), inf where given up
    """
    side, planes, guides = known.shape[0], texture.shape[2], guide.shape[2]
    result = np.full(len(rows), np.inf)
    for n in range(len(rows)):
        y, x = rows[n], columns[n]
        total = 0.0
        for i in range(side):
            for j in range(side):
                if known[i, j]:
                    for k in range(planes):
                        difference = np.float64(texture[y + i, x + j, k]) - np.float64(values[i, j, k])
                        total += difference * difference
            for j in range(side if guides else 0):
                for k in range(guides):
                    difference = np.float64(guide[y + i, x + j, k]) - np.float64(wanted[i, j, k])
                    total += difference * difference
            if total > limit:
                break
        if total <= limit:
            result[n] = total
    return result
