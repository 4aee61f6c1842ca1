"""Hot and dead pixels: texels that differ from their neighbours in the same way in nearly every slice."""

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]

_MOST_SLICES = 64
_DARK_SHARE = 0.1
_LEAST_CONTRAST, _OVER_SPREAD, _OVER_SLOPE = 0.05, 8.0, 1.0
_NEARLY_EVERY = 0.8
_RING_1, _RING_2 = (
    [(y, x) for y in range(-r, r + 1) for x in range(-r, r + 1) if max(abs(y), abs(x)) == r] for r in (1, 2)
)
# Mean squared distances of the rings are 1.5 and 5.5, so that a paraboloid's middle is r₁ + 1.5/4·(r₁ − r₂).
_EXTRAPOLATION = 1.5 / (5.5 - 1.5)


def find_still(slices: F32, valid: Mask) -> Mask:
    """Find marks of up to two texels that stand still in the picture.

    The median over the turn forgets what turns. There a mark stands out from the paraboloid through the two rings
    around it; a highlight's top does not, for its rings fall off with it. Not found: marks in the outermost texels
    (no ring), and those that are as bright as the material. A lamp's mirror image of one texel counts as a mark.

    Parameters
    ----------
    slices : (N, S, S, 3) float32, linear light
    valid : (S, S) bool

    Returns
    -------
    still : (S, S) bool
    """
    some = slices[:: -(-len(slices) // _MOST_SLICES)]
    dark = _DARK_SHARE * np.median(some[:, valid], axis=(0, 1)) + 1e-6
    middle = np.log(np.maximum(np.median(some, axis=0), 0) + dark)
    inner = ndimage.binary_erosion(valid, np.ones((3, 3)))
    rows, columns = ndimage.distance_transform_edt(~valid, return_distances=False, return_indices=True)
    strays, slopes, levels = _strays(middle[rows, columns])
    usual = 1.4826 * np.median(np.abs(strays[inner]), axis=0)
    rough = cv2.blur(np.minimum(np.abs(strays), 4 * usual).astype(np.float32), (9, 9))
    limit = np.maximum(np.maximum(_OVER_SLOPE * slopes, _OVER_SPREAD * np.maximum(usual, rough)), _LEAST_CONTRAST)
    # Beside a mark the rings are not to be trusted; its middle strays most.
    middles = np.abs(strays) == ndimage.maximum_filter(np.abs(strays), (5, 5, 1))
    # What is no more than a kink (light's edge, where a lamp sets) does not stand out from the outer ring.
    beyond = (np.abs(strays) > limit) & (np.abs(levels) > limit) & inner[..., None] & middles
    still = np.zeros(valid.shape, bool)
    for row, column, channel in np.argwhere(beyond):
        if _stays(some, dark, (row, column, channel), float(strays[row, column, channel])):
            still |= _spread(levels[..., channel], limit[..., channel], row, column)
    return still & valid


def _strays(picture: F32) -> tuple[F32, F32, F32]:
    """Give stray from the rings' paraboloid, fall between the rings, and stray from the outer ring; (S, S, 3) each."""
    padded = np.pad(picture, ((2, 2), (2, 2), (0, 0)), mode="edge")

    def ring(offsets: list[tuple[int, int]]) -> F32:
        height, width = picture.shape[:2]
        shifted = [padded[2 + y : 2 + y + height, 2 + x : 2 + x + width] for y, x in offsets]
        return np.asarray(np.median(shifted, axis=0))

    near, far = ring(_RING_1), ring(_RING_2)
    return picture - near - _EXTRAPOLATION * (near - far), np.abs(near - far), picture - far


def _stays(slices: F32, dark: F32, place: tuple[int, int, int], stray: float) -> bool:
    """Whether the texel differs from its ring by at least half as much, on the same side, in nearly every slice."""
    row, column, channel = place
    ring = np.median([slices[:, row + y, column + x, channel] for y, x in _RING_1], axis=0)
    light = slices[:, row, column, channel]
    each = np.log(np.maximum(light, 0) + dark[channel]) - np.log(np.maximum(ring, 0) + dark[channel])
    return float(np.mean(each * np.sign(stray) > 0.3 * abs(stray))) >= _NEARLY_EVERY


def _spread(levels: F32, limit: F32, row: int, column: int) -> Mask:
    """Take the neighbours that share the texel's mark: a quarter of its stray or more, on the same side."""
    mark = np.zeros(levels.shape, bool)
    window = slice(max(row - 1, 0), row + 2), slice(max(column - 1, 0), column + 2)
    share = levels[window] / levels[row, column]
    mark[window] = (share > 0.25) & (np.abs(levels[window]) > limit[window] / 2)
    mark[row, column] = True
    return mark
