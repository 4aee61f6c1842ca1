"""From a picture of the sphere to a slice of the table: a texel gets the mean light of the area it stands for."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.geometry import SphereView, texel_plane
from processing.amc.outline.circle import Circle

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
    shares : (S·n, S·n, 3) float32, what each sample has to say of its texel's mean; 0 where it misses the sphere
    valid : (S, S) bool, texels that hold what was seen
    """

    columns: F32
    rows: F32
    shares: F32
    valid: NDArray[np.bool_]

    def __call__(self, linear: F32, shift_px: tuple[float, float] = (0.0, 0.0)) -> F32:
        """Resample one picture (H, W, 3) of linear light to (S, S, 3); texels outside are black.

        Parameters
        ----------
        shift_px : how much further right and down the sphere is in this picture
        """
        columns, rows = self.columns, self.rows
        if any(shift_px):
            columns, rows = columns + np.float32(shift_px[0]), rows + np.float32(shift_px[1])
        samples = cv2.remap(linear, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        cv2.multiply(samples, self.shares, dst=samples)
        size = self.valid.shape
        return np.asarray(cv2.resize(samples, (size[1], size[0]), interpolation=cv2.INTER_AREA), np.float32)


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
    shares, valid = _shares(seen, size)
    return Resampler(
        columns=(circle.x_px + n_x * scale - 0.5).astype(np.float32),
        rows=(circle.y_px - n_y * scale - 0.5).astype(np.float32),
        shares=shares,
        valid=valid,
    )


def dilate(slices: F32, valid: NDArray[np.bool_], out: F32 | None = None) -> F32:
    """Carry the colours of valid texels outwards: an invalid one takes that of its nearest valid one.

    Parameters
    ----------
    slices : (..., S, S, 3)
    valid : (S, S) bool, true somewhere
    out : where to put the result; may be `slices` itself
    """
    nearest = ndimage.distance_transform_edt(~valid, return_distances=False, return_indices=True)
    outside = ~valid
    carried = slices.copy() if out is None else out
    carried[..., outside, :] = slices[..., nearest[0][outside], nearest[1][outside], :]
    return carried


def _samples_per_texel(circle: Circle, size: int) -> int:
    """Enough that neighbouring samples lie within a pixel of each other, also at the disc's centre."""
    return int(np.clip(np.ceil(2 * circle.radius_px / size), 2, _MOST_SAMPLES))


def _shares(seen: NDArray[np.bool_], size: int) -> tuple[F32, NDArray[np.bool_]]:
    """Return 1 over the share of a texel's samples that see the sphere, for those that do; and texels that have one."""
    part = len(seen) // size
    share = seen.reshape(size, part, size, part).mean(axis=(1, 3))
    each = np.repeat(np.repeat(1 / np.maximum(share, 1e-9), part, axis=0), part, axis=1)
    return np.repeat(np.where(seen, each, 0)[..., None], 3, axis=-1).astype(np.float32), share > 0
