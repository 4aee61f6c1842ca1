"""Reading a dual paraboloid map between its texels."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.paraboloid.maps import Floats, places

F32 = NDArray[np.float32]


def look_up(front: Floats, back: Floats, directions: Floats) -> F32:
    """Read a map (S, S, C) each at unit directions (..., 3), bilinearly; corners must go on across the seam.

    Returns
    -------
    values : (..., C) float32
    """
    directions = np.asarray(directions)
    in_front, columns, rows = places(directions.reshape(-1, 3))
    size, channels = front.shape[0], front.shape[2]
    values = np.zeros((len(columns), channels), np.float32)
    for half, here in ((front, in_front), (back, ~in_front)):
        at = np.stack([rows[here], columns[here]]) * size - 0.5
        for c in range(channels):
            values[here, c] = ndimage.map_coordinates(half[..., c], at, order=1, mode="nearest")
    return values.reshape(*directions.shape[:-1], channels)
