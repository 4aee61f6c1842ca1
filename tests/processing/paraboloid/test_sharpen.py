"""A blur taken back: edges get steeper, and noise does not get louder."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import erf

from litrig.base.errors import InputError
from processing.paraboloid.blur import blurred, resized
from processing.paraboloid.maps import texel_directions
from processing.paraboloid.sharpen import sharpened

F32 = NDArray[np.float32]
SIZE, OLD, TAKEN = 48, 0.03, 0.02
HEIGHTS = np.stack([np.arcsin(side @ np.array([0.6, 0.0, 0.8])) for side in texel_directions(SIZE)])
WITHIN = np.stack(
    [side[..., 0] ** 2 + side[..., 1] ** 2 < (1 + abs(side[..., 2])) ** 2 for side in texel_directions(SIZE)]
)


def edge(variance: float) -> F32:
    light = 0.5 + 0.4 * erf(HEIGHTS / np.sqrt(2 * variance))
    return np.repeat(light[..., None], 3, axis=-1).astype(np.float32)


def lamp(size: int, sharpness: float) -> tuple[F32, F32]:
    front, back = (
        np.exp(sharpness * (side @ np.array([0.6, 0.0, 0.8]) - 1))[..., None] * np.ones(3)
        for side in texel_directions(size)
    )
    return front.astype(np.float32), back.astype(np.float32)


def steepness(light: F32) -> float:
    near = (np.abs(HEIGHTS) < 0.1) & WITHIN
    return float(np.polyfit(HEIGHTS[near], light[near][:, 0], 1)[0])


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03])
def test_an_edge_gets_steeper_and_flat_noise_does_not_grow(noise: float) -> None:
    rng = np.random.default_rng(5)
    given = edge(OLD) + noise * rng.normal(size=(2, SIZE, SIZE, 3)).astype(np.float32)
    found = np.stack(sharpened(given[0], given[1], TAKEN))
    flat = (np.abs(HEIGHTS) > 1.1) & WITHIN
    assert found[flat].std() <= given[flat].std() * 1.001 + 1e-3
    assert steepness(found) > 1.25 * steepness(given)
    assert steepness(found) < 1.05 * steepness(edge(OLD - TAKEN))
    assert found.min() >= min(given.min(), 0)


def test_a_highlight_comes_nearer_to_the_sharp_one_and_keeps_its_light() -> None:
    sharp = lamp(SIZE, 60)
    soft = blurred(*sharp, TAKEN)
    found = sharpened(*soft, TAKEN)
    before, after = (np.abs(np.stack(pair) - np.stack(sharp))[WITHIN].mean() for pair in (soft, found))
    assert after < 0.35 * before
    assert np.stack(found).max() > 1.3 * np.stack(soft).max()


def test_large_maps_are_sharpened_as_small_ones_are() -> None:
    """A blur this large is taken back on smaller copies."""
    small, large = (np.stack(sharpened(*blurred(*lamp(size, 12), 0.1), 0.1, 4)) for size in (48, 96))
    soft = np.stack(blurred(*lamp(96, 12), 0.1))
    np.testing.assert_allclose(np.stack(resized(large[0], large[1], 48)), small, atol=0.02)
    assert large.max() > 1.2 * soft.max()


def test_nothing_taken_changes_nothing() -> None:
    given = edge(OLD)
    np.testing.assert_array_equal(np.stack(sharpened(given[0], given[1], 0.0)), given)


@pytest.mark.parametrize("variance", [-0.1, np.nan])
def test_what_is_no_variance_is_refused(variance: float) -> None:
    with pytest.raises(InputError, match="sharpen: a variance"):
        sharpened(edge(OLD)[0], edge(OLD)[1], variance)
