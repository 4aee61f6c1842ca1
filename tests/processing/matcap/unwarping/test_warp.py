import numpy as np
import pytest
from numpy.typing import NDArray

from processing.matcap.disc import disc_normals, spread_out
from processing.matcap.unwarping.warp import unwarped
from processing.paraboloid.maps import texel_directions

F64 = NDArray[np.float64]


def seen_light(directions: F64) -> F64:
    """Some smooth light over all directions."""
    x, y, z = np.moveaxis(directions, -1, 0)
    return np.stack([0.5 + 0.4 * x, 0.5 + 0.3 * y * z, 0.6 - 0.3 * z], axis=-1)


@pytest.mark.parametrize("slope", [0.0, 0.4, 0.97])
def test_a_texel_shows_what_the_normal_sees_that_turns_to_it(slope: float) -> None:
    normals, inside = disc_normals(256)
    angles = np.arccos(normals[..., 2:]) * (1 + slope)
    across = np.maximum(np.hypot(normals[..., :1], normals[..., 1:2]), 1e-9)
    turned = np.concatenate([normals[..., :2] / across * np.sin(angles), np.cos(angles)], axis=-1)
    disc = spread_out(seen_light(turned).astype(np.float32), inside)
    for texels, directions in zip(unwarped(disc, slope, 96), texel_directions(96), strict=True):
        # Within the disc by three pixels; the corners beyond the unit circle are among them.
        shown = np.arccos(directions[..., 2]) / (1 + slope) < np.arcsin(1 - 3 / 128)
        np.testing.assert_allclose(texels[shown], seen_light(directions)[shown], atol=0.02)


def test_texels_that_cover_many_pixels_are_their_mean() -> None:
    stripes = np.zeros((512, 512, 3), np.float32)
    stripes[::2] = 1
    front, _ = unwarped(stripes, 0.9, 16)
    assert np.abs(front[5:11, 5:11] - 0.5).max() < 0.15
