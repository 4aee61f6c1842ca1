"""The sample's own frame: where a place of the turning sample is in each slice.

The sample turns about z through the disc's centre, by equal angles in every table whose normals keep their azimuth. So
the place at q in the frame of one slice is at q turned by the difference of the two turntable angles in another, and
whatever sticks to the sample (a cut, a thread) stands still here while the light goes round.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]


def turn(picture: F32, turn_rad: float, interpolation: int = cv2.INTER_LINEAR) -> F32:
    """Turn what sticks to the sample, counter-clockwise as the camera sees it.

    Parameters
    ----------
    picture : (S, S) or (S, S, C) float32, row 0 at n_y = +1
    turn_rad : how far the sample has turned; the negative takes a slice back into the sample's frame
    interpolation : OpenCV's name of one

    Returns
    -------
    turned : float32 of the same shape; the border's colours reach outwards where the square's corners turn in
    """
    size = (picture.shape[1], picture.shape[0])
    back = _back(turn_rad, len(picture), len(picture))
    flags = interpolation | cv2.WARP_INVERSE_MAP
    turned = cv2.warpAffine(picture, back, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(turned, np.float32)


def turn_mask(mask: Mask, turn_rad: float) -> Mask:
    """Turn marked texels; every texel that a turned one touches is marked.

    A quarter of a texel is touched only from within 1/2 + 1/(2·√2) < 1 texel on both axes, which is as far as linear
    interpolation at its centre reaches: so the answer is complete, and dilated by half a texel at most.

    Parameters
    ----------
    mask : (S, S) bool
    turn_rad : how far the sample has turned

    Returns
    -------
    marked : (S, S) bool
    """
    size = len(mask)
    back = _back(turn_rad, size, 2 * size)
    quarters = cv2.warpAffine(
        mask.astype(np.float32), back, (2 * size, 2 * size), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    marked: Mask = quarters.reshape(size, 2, size, 2).max(axis=(1, 3)) > 0
    return marked


def track(mask: Mask, turns_rad: F64) -> Mask:
    """Follow marks through the turn (the AMC paper, section 5.1).

    Parameters
    ----------
    mask : (S, S) bool, marks on one slice
    turns_rad : (N,) turntable angle of each slice less that of the marked one

    Returns
    -------
    marked : (N, S, S) bool, every texel that a mark touches
    """
    marked = np.zeros((len(turns_rad), *mask.shape), bool)
    for index, turn_rad in enumerate(turns_rad):
        marked[index] = turn_mask(mask, float(turn_rad))
    return marked


def _back(turn_rad: float, size: int, out_size: int) -> F64:
    """From pixels of the turned picture, perhaps a finer one, to those of the picture before; rows count downwards."""
    cosine, sine = np.cos(turn_rad), np.sin(turn_rad)
    step = size / out_size
    linear = np.array([[cosine, -sine], [sine, cosine]])
    shift = (size - 1) / 2 - linear @ np.full(2, step * (out_size - 1) / 2)
    return np.column_stack([linear * step, shift])
