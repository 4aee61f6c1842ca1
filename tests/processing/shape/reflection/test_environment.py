from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from litrig.base.errors import InputError
from processing.paraboloid.maps import texel_directions
from processing.shape.reflection.environment import Interpolation, ReflectionOptions, reconstruct_reflection, see
from processing.shape.reflection.regularise import breaks, smooth
from tests.processing.matcap.maps import sharp
from tests.processing.shape.reflection.balls import ball

SMALL = ReflectionOptions(64)


@pytest.mark.parametrize("interpolation", ["triangles", "quads"])
def test_a_ball_gives_back_what_it_mirrors(interpolation: Interpolation) -> None:
    seen = ball(120)
    found = reconstruct_reflection(*seen, replace(SMALL, interpolation=interpolation))
    assert 0.85 < found.coverage < 1
    assert found.remarks == ()
    known = see(*seen[:4], seen.used, replace(SMALL, interpolation=interpolation)).known
    for half, mask, directions in zip((found.front, found.back), known, texel_directions(64), strict=True):
        wrong = np.abs(half - sharp(directions))
        assert wrong[mask].mean() < 1e-3
        assert wrong[mask].max() < 0.08
        # The corners too, and what is filled in behind the ball.
        assert wrong.max() < 0.1


def test_what_a_ball_shows_has_no_cracks() -> None:
    whole = ball(100)
    seen = see(*whole[:4], whole.used, SMALL)
    along = (2 * np.arange(64) + 1) / 64 - 1
    within = along**2 + along[:, None] ** 2 <= 1
    for half, most in ((0, 0), (1, 1)):
        _, holes = ndimage.label(ndimage.binary_opening(within & ~seen.known[half]))
        assert holes == most
    assert seen.known[0][within].all()


def test_occluded_pixels_count_for_nothing() -> None:
    seen = ball(80)
    covered = seen.normals[..., 0] > 0.1
    wrong = np.where(covered[..., None], 7, seen.reflection).astype(np.float32)
    occlusion = np.where(covered, 0.4, 1).astype(np.float32)
    found = reconstruct_reflection(wrong, *seen[1:4], occlusion, seen.used, SMALL)
    assert max(found.front.max(), found.back.max()) < 2
    counted = reconstruct_reflection(wrong, *seen[1:4], occlusion, seen.used, replace(SMALL, occlusion_threshold=0.3))
    assert counted.front.max() > 6.9


def test_a_surface_that_is_occluded_everywhere_is_taken_all_the_same_and_said() -> None:
    seen = ball(40)
    found = reconstruct_reflection(*seen[:4], np.zeros_like(seen.occlusion), seen.used, SMALL)
    assert found.remarks == ("it is occluded everywhere; its reflections are taken all the same",)


def test_a_surface_that_shows_little_says_how_much() -> None:
    """The paper's figure 13."""
    seen = ball(60)
    middle = seen.used & (seen.normals[..., 2] > 0.97)
    found = reconstruct_reflection(*seen[:5], middle, SMALL)
    assert f"shows {found.coverage:.0%} of all reflected directions" in found.remarks[0]
    assert found.coverage == pytest.approx((1 - np.cos(2 * np.arccos(0.97))) / 2, abs=0.04)
    assert np.isfinite(found.front).all()


def test_one_pixel_lights_everything() -> None:
    seen = ball(40)
    one = np.zeros_like(seen.used)
    one[20, 30] = True
    found = reconstruct_reflection(*seen[:5], one, SMALL)
    np.testing.assert_allclose(found.front, np.broadcast_to(seen.reflection[20, 30], (64, 64, 3)), atol=1e-5)
    np.testing.assert_allclose(found.back, np.broadcast_to(seen.reflection[20, 30], (64, 64, 3)), atol=1e-5)


def test_a_line_of_single_pixels_is_taken_as_points() -> None:
    seen = ball(60)
    line = np.zeros_like(seen.used)
    line[30] = seen.used[30]
    partial = see(*seen[:4], line, SMALL)
    assert partial.known.sum() > 20
    for half, directions in enumerate(texel_directions(64)):
        known = partial.known[half]
        np.testing.assert_allclose(partial.halves[half][known], sharp(directions)[known], atol=0.35)


def test_no_pixel_at_all_is_an_error() -> None:
    seen = ball(20)
    with pytest.raises(InputError, match="no pixel"):
        reconstruct_reflection(*seen[:5], np.zeros_like(seen.used), SMALL)


def test_one_smooth_patch_has_no_breaks_and_overlapping_ones_have() -> None:
    for bumps, broken in ((0.0, False), (0.3, True)):
        seen = ball(120, bumps=bumps)
        partial = see(*seen[:4], seen.used, SMALL)
        found = breaks(partial.pixels, partial.narrowness, partial.known, 120.0)
        inner = found[0][8:-8, 8:-8]
        assert (inner > 0.5).any() == broken
        if not broken:
            assert found.max() < 0.1


def test_the_blur_smooths_breaks_and_leaves_the_rest_bit_by_bit() -> None:
    halves = np.zeros((2, 64, 64, 3), np.float32)
    halves[:, :, 32:] = 1
    halves += np.random.default_rng(0).uniform(0, 0.1, halves.shape).astype(np.float32)
    broken = np.zeros((2, 64, 64))
    broken[0, :, 31:33] = 1
    found = smooth(halves, broken, 5.0)
    np.testing.assert_array_equal(found[1], halves[1])
    np.testing.assert_array_equal(found[0, :, :20], halves[0, :, :20])
    steps = [np.abs(np.diff(half[20:44].mean(axis=(0, 2)))).max() for half in (halves[0], found[0])]
    assert steps[1] < 0.5 * steps[0]
    flat = np.full((2, 64, 64, 3), 0.3, np.float32)
    np.testing.assert_allclose(smooth(flat, broken, 5.0), 0.3, rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"size": 1}, "1 texels"),
        ({"size": 100_000}, "100000 texels"),
        ({"occlusion_threshold": 1.5}, "threshold of 1.5"),
        ({"occlusion_threshold": float("nan")}, "threshold of nan"),
        ({"blur_deg": -1.0}, "blur of -1"),
    ],
)
def test_options_that_mean_nothing_are_refused(changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        ReflectionOptions(**changes)
