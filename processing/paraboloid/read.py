"""Reading dual paraboloid maps between their texels."""

import numpy as np

from processing.paraboloid.maps import F64, Floats, places


def lookup(front: Floats, back: Floats, directions: Floats) -> F64:
    """Read a map (S, S, C) each at unit directions (..., 3), bilinearly; corners must go on across the seam.

    Returns
    -------
    values : (..., C) float64
    """
    in_front, columns, rows = places(directions)
    size = front.shape[0]
    x, y = (np.clip(place * size - 0.5, 0, size - 1) for place in (columns, rows))
    left, top = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    right, bottom = np.minimum(left + 1, size - 1), np.minimum(top + 1, size - 1)
    along, down = (x - left)[..., None], (y - top)[..., None]
    texels = np.stack([front, back])
    side = np.where(in_front, 0, 1)
    above = texels[side, top, left] * (1 - along) + texels[side, top, right] * along
    below = texels[side, bottom, left] * (1 - along) + texels[side, bottom, right] * along
    return np.asarray(above * (1 - down) + below * down, np.float64)
