"""The disc that a MatCap shows: the picture of a sphere, seen from afar, inscribed in a square."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from litrig.base.errors import InputError

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bools = NDArray[np.bool_]
SMALLEST_SIDE, LARGEST_SIDE = 4, 8192


def disc_normals(size: int) -> tuple[F64, Bools]:
    """Return the normals of a disc's pixel centres.

    Returns
    -------
    normals : (S, S, 3) unit, view frame, row 0 at n_y = +1; outside the disc (0, 0, 1), which means nothing
    inside : (S, S) bool, whether the centre lies within the disc
    """
    along = (2 * np.arange(size) + 1) / size - 1
    x, y = np.meshgrid(along, -along)
    across = x * x + y * y
    inside = across < 1
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - across, 0))], axis=-1)
    normals[~inside] = (0.0, 0.0, 1.0)
    return normals, inside


def rim_distances_px(size: int) -> F64:
    """Return how far within the disc each pixel's centre lies (S, S), in pixels; negative outside."""
    along = np.arange(size) + 0.5 - size / 2
    distances: F64 = size / 2 - np.hypot(along[None], along[:, None])
    return distances


def spread_out(picture: F32, known: Bools) -> F32:
    """Give each unknown pixel of a picture (S, S, 3) the colour of the known one next to it; one must be known."""
    rows, columns = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.ascontiguousarray(picture[rows, columns])


def check_disc(picture: NDArray[np.floating], source: str) -> None:
    """Refuse what cannot be a MatCap.

    Raises
    ------
    InputError
        The picture is not square, too small or too large, holds what is no number, or is darker than black.
    """
    if picture.ndim != 3 or picture.shape[2] != 3:
        raise InputError(f"{source}: an array {picture.shape} is no picture; give (S, S, 3)")
    height, width = picture.shape[:2]
    if height != width:
        raise InputError(
            f"{source}: {width} × {height} is no MatCap; crop it to the square round the sphere, or let "
            "litrig amc matcap find it"
        )
    if not SMALLEST_SIDE <= width <= LARGEST_SIDE:
        raise InputError(f"{source}: {width} pixels on a side; a MatCap has {SMALLEST_SIDE} to {LARGEST_SIDE}")
    if not np.all(np.isfinite(picture)):
        raise InputError(f"{source}: holds what is no number; render it again")
    if picture.min() < 0:
        raise InputError(f"{source}: holds values below 0 (down to {picture.min():.3g}), which no light has; clip them")
