"""From a picture of the sphere to a slice of the table: a texel gets the mean light of the area it stands for."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.errors import InputError
from litrig.base.kernels import kernel
from processing.amc.geometry import SphereView, texel_plane
from processing.outline.circle import Circle

F32 = NDArray[np.float32]
Number = TypeVar("Number", bound=np.generic)

# The outermost pixels mix sphere and background, and interpolation reaches a pixel further in both directions.
_RIM_PX = 1.5
_MOST_SAMPLES = 16


@dataclass(frozen=True)
class Resampler:
    """Takes pictures of one sphere to S×S slices.

    Attributes
    ----------
    places : (P, 2) float32, column and row in the picture of every sample that sees the sphere, texel by texel; the
        centre of the first pixel is (0, 0)
    starts : (S·S + 1,) where the samples of each texel start
    valid : (S, S) bool, texels that hold what was seen
    """

    places: F32
    starts: NDArray[np.int64]
    valid: NDArray[np.bool_]

    def __call__(self, linear: F32, shift_px: tuple[float, float] = (0.0, 0.0), out: F32 | None = None) -> F32:
        """Resample one picture (H, W, 3) of linear light to (S, S, 3); texels outside are black.

        Parameters
        ----------
        shift_px : how much further right and down the sphere is in this picture
        out : where to put the result
        """
        if min(linear.shape[:2]) < 2:
            raise InputError(
                f"a picture of {linear.shape[1]} × {linear.shape[0]} pixels shows no sphere; give a larger one"
            )
        light = np.zeros((*self.valid.shape, 3), np.float32) if out is None else out
        shift = np.array(shift_px, np.float32)
        _resample(np.ascontiguousarray(linear, np.float32), self.places, self.starts, shift, light.reshape(-1, 3))
        return light


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
    # All four quarters of the plane are alike in how far out they are.
    count = len(n_x)
    quarter = slice(count // 2, None)
    flat = np.hypot(n_x[quarter, quarter], n_y[quarter, quarter])
    table_angle = np.arcsin(np.minimum(flat, 1))
    radius_px = circle.radius_px * view.image_radius(view.true_angle_rad(table_angle))
    seen = (flat < 1) & (table_angle <= view.largest_table_angle_rad()) & (radius_px <= circle.radius_px - _RIM_PX)
    mirrored = np.abs(2 * np.arange(count) - count + 1) // 2
    everywhere = np.ix_(mirrored, mirrored)
    seen, scale = seen[everywhere], (radius_px / np.maximum(flat, 1e-12))[everywhere]
    places = np.stack([circle.x_px + n_x * scale - 0.5, circle.y_px - n_y * scale - 0.5], axis=-1).astype(np.float32)
    seen_by_texel = _by_texel(seen, size)
    counts = seen_by_texel.sum(axis=1)
    return Resampler(
        places=_by_texel(places, size)[seen_by_texel],
        starts=np.concatenate([[0], np.cumsum(counts)]),
        valid=(counts > 0).reshape(size, size),
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


def _by_texel(samples: NDArray[Number], size: int) -> NDArray[Number]:
    """Put the n×n samples of each texel side by side: (S·n, S·n, ...) becomes (S·S, n·n, ...)."""
    part = len(samples) // size
    grid = samples.reshape(size, part, size, part, *samples.shape[2:]).swapaxes(1, 2)
    return grid.reshape(size * size, part * part, *samples.shape[2:])


@kernel
def _resample(picture: F32, places: F32, starts: NDArray[np.int64], shift: F32, light: F32) -> None:
    """Average bilinear samples; the picture goes on beyond its border as it ends there."""
    height, width = picture.shape[:2]
    flat = picture.reshape(-1)
    one, right, down = np.uint64(1), np.uint64(3), np.uint64(3 * width)  # unsigned: none can be below zero
    for texel in range(len(light)):
        red, green, blue = np.float32(0), np.float32(0), np.float32(0)
        for sample in range(starts[texel], starts[texel + 1]):
            x = min(max(places[sample, 0] + shift[0], np.float32(0)), np.float32(width - 1))
            y = min(max(places[sample, 1] + shift[1], np.float32(0)), np.float32(height - 1))
            column, row = min(np.int32(x), np.int32(width - 2)), min(np.int32(y), np.int32(height - 2))
            u, v = x - np.float32(column), y - np.float32(row)
            w3 = u * v
            w0, w1, w2 = np.float32(1) - u - v + w3, u - w3, v - w3
            a = np.uint64(row) * down + np.uint64(column) * right
            b, c, d = a + right, a + down, a + down + right
            red += w0 * flat[a] + w1 * flat[b] + w2 * flat[c] + w3 * flat[d]
            a, b, c, d = a + one, b + one, c + one, d + one
            green += w0 * flat[a] + w1 * flat[b] + w2 * flat[c] + w3 * flat[d]
            a, b, c, d = a + one, b + one, c + one, d + one
            blue += w0 * flat[a] + w1 * flat[b] + w2 * flat[c] + w3 * flat[d]
        share = np.float32(1) / np.float32(max(starts[texel + 1] - starts[texel], 1))
        light[texel, 0], light[texel, 1], light[texel, 2] = red * share, green * share, blue * share
