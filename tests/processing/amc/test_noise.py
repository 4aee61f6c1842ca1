import numpy as np
import pytest

from litrig.base.table_normals import TableNormal
from processing.amc.geometry import SphereView, texel_plane
from processing.amc.noise import difference_gain, noise_variance
from processing.amc.resample import make_resampler
from processing.outline.circle import Circle

SIGMA = 0.02


@pytest.mark.parametrize("slices", [8, 24, 128])
@pytest.mark.parametrize("radius_px", [20, 60, 110], ids=["texels share pixels", "a few pixels", "many pixels"])
def test_the_noise_of_a_resampled_turn_is_measured(slices: int, radius_px: int) -> None:
    """Sensor noise under a sharp highlight that goes round; what counts is what is left of it in a texel."""
    random = np.random.default_rng(slices)
    side = 2 * radius_px + 10
    resample = make_resampler(Circle(side / 2, side / 2, radius_px), SphereView(TableNormal.RECTIFIED), 48)
    n_x, n_y = texel_plane(48)
    noisy, clean = [], []
    for angle in 2 * np.pi * np.arange(slices) / slices:
        streak = np.exp(-(((n_x - 0.2) * np.cos(angle) + (n_y - 0.1) * np.sin(angle)) ** 2) / 0.05)
        clean.append(np.repeat(streak[..., None], 3, axis=-1).astype(np.float32))
        noisy.append(clean[-1] + resample(SIGMA * random.standard_normal((side, side, 3)).astype(np.float32)))
    truth = np.mean((np.stack(noisy) - np.stack(clean))[:, resample.valid] ** 2)
    found = noise_variance(np.stack(noisy), resample.valid, difference_gain(resample, (side, side)))
    tolerance = 1.3 if slices == 8 else 0.2
    assert truth * 0.85 < found < truth * (1 + tolerance)


def test_a_smooth_turn_has_no_noise() -> None:
    n_x, _ = texel_plane(32)
    angles = 2 * np.pi * np.arange(32) / 32
    slices = 0.5 + 0.2 * np.cos(angles)[:, None, None, None] * np.repeat(n_x[..., None], 3, axis=-1)
    assert noise_variance(slices.astype(np.float32), np.hypot(*texel_plane(32)) < 0.9) < 1e-9
