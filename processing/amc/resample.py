"""From a picture of the sphere to a slice of the table: a texel gets the mean light of the area it stands for."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.circle import Circle
from processing.amc.geometry import SphereView, texel_plane

F32 = NDArray[np.float32]

# The outermost pixels mix sphere and background, and interpolation reaches a pixel further in both directions.
_RIM_PX = 1.5
_MOST_SAMPLES = 16


@dataclass(frozen=True)
class Resampler:
    """Takes pictures of one sphere to S×S slices.

    Attributes
    ----------
    columns, rows : (S·n, S·n) float32, where in the picture each of the n×n samples of a texel lies; OpenCV's
        coordinates, which call the centre of the first pixel (0, 0)
    weights : (S·n, S·n) float32, 1 where a sample falls on the sphere
    valid : (S, S) bool, texels that hold what was seen
    """

    columns: F32
    rows: F32
    weights: F32
    valid: NDArray[np.bool_]

    def __call__(self, linear: F32) -> F32:
        """Resample one picture (H, W, 3) of linear light to (S, S, 3); texels outside take their nearest neighbour."""
        samples = cv2.remap(linear, self.columns, self.rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        weighted = _sum_blocks(samples * self.weights[..., None], len(self.valid))
        counts = _sum_blocks(self.weights[..., None], len(self.valid))
        return dilate((weighted / np.maximum(counts, 1)).astype(np.float32), self.valid)


def make_resampler(circle: Circle, view: SphereView, size: int) -> Resampler:
    """Prepare the way from picture to table.

    Parameters
    ----------
    circle : the silhouette in the pictures
    view : distance and kind of table normal
    size : S, texels along each side
    """
    supersample = _samples_per_texel(circle, size)
    n_x, n_y = texel_plane(size, supersample)
    flat = np.hypot(n_x, n_y)
    table_angle = np.arcsin(np.minimum(flat, 1))
    radius_px = circle.radius_px * view.image_radius(view.true_angle_rad(table_angle))
    seen = (flat < 1) & (table_angle <= view.largest_table_angle_rad()) & (radius_px <= circle.radius_px - _RIM_PX)
    scale = radius_px / np.maximum(flat, 1e-12)
    weights = seen.astype(np.float32)
    return Resampler(
        columns=(circle.x_px + n_x * scale - 0.5).astype(np.float32),
        rows=(circle.y_px - n_y * scale - 0.5).astype(np.float32),
        weights=weights,
        valid=_sum_blocks(weights[..., None], size)[..., 0] > 0,
    )


def dilate(slices: F32, valid: NDArray[np.bool_]) -> F32:
    """Carry the colours of valid texels outwards: an invalid one takes that of its nearest valid one.

    Parameters
    ----------
    slices : (..., S, S, 3)
    valid : (S, S) bool, true somewhere
    """
    nearest = ndimage.distance_transform_edt(~valid, return_distances=False, return_indices=True)
    carried: F32 = slices[..., nearest[0], nearest[1], :]
    return carried


def _samples_per_texel(circle: Circle, size: int) -> int:
    """Enough that neighbouring samples lie within a pixel of each other, also at the disc's centre."""
    return int(np.clip(np.ceil(2 * circle.radius_px / size), 2, _MOST_SAMPLES))


def _sum_blocks(samples: F32, size: int) -> F32:
    part = len(samples) // size
    summed: F32 = samples.reshape(size, part, size, part, -1).sum(axis=(1, 3))
    return summed
