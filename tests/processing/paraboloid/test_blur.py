"""Blur over all directions, against what spherical harmonics say that heat does."""

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.paraboloid.blur import blurred, resized
from processing.paraboloid.maps import texel_directions

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
_AXIS = np.array([0.3, 0.5, 0.8124])
_ORDERS = (2, 4, 8)


def harmonics(directions: F64) -> F64:
    """Legendre polynomials about three axes, one a channel."""
    cosines = (directions @ (_AXIS / np.linalg.norm(_AXIS)), directions[..., 1], directions[..., 0])
    return np.stack(
        [np.polynomial.legendre.legval(x, [0] * order + [1]) for x, order in zip(cosines, _ORDERS, strict=True)],
        axis=-1,
    )


def sides(size: int) -> tuple[F32, F32]:
    front, back = texel_directions(size)
    return harmonics(front).astype(np.float32), harmonics(back).astype(np.float32)


@pytest.mark.parametrize("variance", [0.0005, 0.01, 0.05, 0.4])
@pytest.mark.parametrize("size", [48, 64])
def test_each_harmonic_fades_as_heat_does(size: int, variance: float) -> None:
    """The corners of the square too, which the other map has."""
    for found, sharp in zip(blurred(*sides(size), variance), sides(size), strict=True):
        for channel, order in enumerate(_ORDERS):
            wanted = sharp[..., channel] * np.exp(-variance * order * (order + 1) / 2)
            assert np.abs(found[..., channel] - wanted).max() < (0.02 if order == 8 else 0.004)


def test_blurs_add_up() -> None:
    twice, once = blurred(*blurred(*sides(64), 0.02), 0.03), blurred(*sides(64), 0.05)
    for first, second in zip(twice, once, strict=True):
        np.testing.assert_allclose(first, second, atol=0.006)


def test_even_light_stays_and_light_is_not_lost() -> None:
    front, back = texel_directions(64)
    q = (front[..., 0] ** 2 + front[..., 1] ** 2) / (1 + front[..., 2]) ** 2
    area = np.clip((1 - np.sqrt(q)) * 32 + 0.5, 0, 1) / (1 + q) ** 2
    lamp = [np.exp(80 * (d @ [0.6, 0.0, 0.8] - 1))[..., None] * np.ones(3, np.float32) for d in (front, back)]
    before = sum(float((side[..., 0] * area).sum()) for side in lamp)
    for variance in (0.01, 0.1, 0.6):
        after = sum(float((side[..., 0] * area).sum()) for side in blurred(lamp[0], lamp[1], variance))
        assert after == pytest.approx(before, rel=0.01)
        even = np.full((64, 64, 3), 0.7, np.float32)
        np.testing.assert_allclose(blurred(even, even, variance), 0.7, atol=1e-5)


def test_a_smaller_result_is_the_same_light() -> None:
    for found, wanted in zip(blurred(*sides(96), 0.05, 24), blurred(*sides(24), 0.05), strict=True):
        np.testing.assert_allclose(found, wanted, atol=0.03)


@pytest.mark.parametrize("size", [40, 64, 100])
def test_maps_of_another_size_hold_the_same_light(size: int) -> None:
    for found, wanted in zip(resized(*sides(64), size), sides(size), strict=True):
        np.testing.assert_allclose(found, wanted, atol=0.02)


@pytest.mark.parametrize("variance", [-0.1, np.nan, np.inf])
def test_what_is_no_variance_is_refused(variance: float) -> None:
    with pytest.raises(InputError, match=r"blur: a variance of .* is none"):
        blurred(*sides(8), variance)


@pytest.mark.parametrize("size", [1, 3, 9, 17, 34])
@pytest.mark.parametrize("variance", [0.0, 1e-9, 0.02, 3.0])
def test_maps_of_any_size_are_blurred(size: int, variance: float) -> None:
    light = np.random.default_rng(size).random((2, size, size, 3), np.float32)
    found = np.stack(blurred(light[0], light[1], variance))
    assert found.shape == light.shape and found.dtype == np.float32
    assert np.all(np.isfinite(found))
    assert found.std() <= light.std() + 1e-6
