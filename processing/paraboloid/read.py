"""Reading dual paraboloid maps between their texels."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.paraboloid.maps import F64, Floats, places


def lookup(front: Floats, back: Floats, directions: Floats) -> F64:
    """Read a map (S, S, C) each at unit directions (..., 3), bilinearly; corners must go on across the seam.

    Returns
    -------
    values : (..., C) float64
    """
    in_front, columns, rows = places(directions)
    size = front.shape[0]
    # The kernel reads anywhere: fmax takes what is no number to an edge as well.
    x, y = (np.fmin(np.fmax(place * size - 0.5, 0), size - 1).ravel() for place in (columns, rows))
    values = np.zeros((x.size, front.shape[2]))
    for texels, here in ((front, in_front), (back, ~in_front)):
        _read(np.ascontiguousarray(texels), np.flatnonzero(here), x, y, values)
    return values.reshape(*in_front.shape, front.shape[2])


@kernel
def _read(texels: Floats, which: NDArray[np.int64], x: F64, y: F64, values: F64) -> None:
    last = texels.shape[0] - 1
    for i in which:
        left, top = int(x[i]), int(y[i])
        right, bottom = min(left + 1, last), min(top + 1, last)
        along, down = x[i] - left, y[i] - top
        for k in range(values.shape[1]):
            above = texels[top, left, k] * (1 - along) + texels[top, right, k] * along
            below = texels[bottom, left, k] * (1 - along) + texels[bottom, right, k] * along
            values[i, k] = above * (1 - down) + below * down
