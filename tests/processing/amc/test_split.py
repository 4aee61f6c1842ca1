"""The low part is the diffuse light, the high part the gloss, and nothing is lost between them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from processing.amc.split import Envelope, fit_envelope
from tests.processing.amc.flaws.flawed_sphere import Material, disc, gloss, lambert, normals

F32 = NDArray[np.float32]

SIZE = 48
VALID = disc(SIZE)
NORMALS = normals(SIZE)
ANGLES_RAD = np.arange(16) * 2 * np.pi / 16


def shot(material: Material, noise: float = 0.0) -> tuple[F32, F32]:
    """Slices, and the diffuse part of each."""
    diffuse = lambert(SIZE, material.light_seed)
    slices = diffuse + gloss(material, SIZE, ANGLES_RAD)
    noisy = slices + noise * np.random.default_rng(0).standard_normal(slices.shape)
    return noisy.astype(np.float32), np.broadcast_to(diffuse, slices.shape).astype(np.float32)


def relative_rms(difference: F32, reference: F32) -> float:
    return float(np.sqrt(np.mean(difference[:, VALID] ** 2) / np.mean(reference[:, VALID] ** 2)))


@pytest.mark.parametrize("light_seed", [0, 1, 2])
@pytest.mark.parametrize("repeats", [1, 2])
def test_narrow_gloss_is_told_from_diffuse_light(repeats: int, light_seed: int) -> None:
    slices, diffuse = shot(Material(repeats, 2.5, 0.8, light_seed), 0.002)
    low = fit_envelope(slices, NORMALS, VALID).below(slices, NORMALS)
    assert relative_rms(low - diffuse, diffuse) < 0.12
    assert relative_rms(slices - low - (slices - diffuse), slices - diffuse) < 0.31
    assert abs(float((low - diffuse)[:, VALID].mean() / diffuse[:, VALID].mean())) < 0.1


def test_diffuse_light_alone_is_all_low() -> None:
    _, diffuse = shot(Material(2), 0.0)
    assert relative_rms(fit_envelope(diffuse, NORMALS, VALID).below(diffuse, NORMALS) - diffuse, diffuse) < 0.08


def test_a_quadratic_is_found_to_rounding() -> None:
    coefficients = np.random.default_rng(1).normal(0, 0.03, (9, 3)).astype(np.float32)
    coefficients[0] += 1
    truth = Envelope(coefficients)
    found = fit_envelope(truth.at(NORMALS)[None], NORMALS, VALID)
    assert np.abs(found.at(NORMALS) - truth.at(NORMALS))[VALID].max() < 2e-3


@settings(deadline=None, max_examples=20)
@given(gain=st.floats(0.01, 100), light_seed=st.integers(0, 5))
def test_both_parts_are_light_and_sum_to_the_slices(gain: float, light_seed: int) -> None:
    slices = np.maximum(shot(Material(2, 1.5, 0.8, light_seed), 0.01)[0][:2] * np.float32(gain), 0)
    low = fit_envelope(slices, NORMALS, VALID).below(slices, NORMALS)
    high = slices - low
    assert low.min() >= 0
    assert high.min() >= 0
    assert low + high == pytest.approx(slices, rel=1e-6, abs=1e-7)


@settings(deadline=None, max_examples=20)
@given(gain=st.floats(0.01, 100))
def test_brighter_slices_have_a_brighter_envelope(gain: float) -> None:
    slices = shot(Material(2, 1.5))[0][:2]
    first, second = (fit_envelope(one, NORMALS, VALID).at(NORMALS) for one in (slices, slices * np.float32(gain)))
    assert second / gain == pytest.approx(first, abs=0.01)


def test_other_tables_of_the_same_sphere_share_the_envelope() -> None:
    """Fitted to one table it is read at the normals of another, of another size: the way to a high part of its own."""
    slices, _ = shot(Material(2, 2.5))
    envelope = fit_envelope(slices, NORMALS, VALID)
    other = envelope.at(normals(2 * SIZE))
    assert other.shape == (2 * SIZE, 2 * SIZE, 3)
    halved = other.reshape(SIZE, 2, SIZE, 2, 3).mean(axis=(1, 3))
    assert np.abs(halved - envelope.at(NORMALS))[disc(SIZE, 0.9)].max() < 0.01


def test_noise_below_zero_leaves_no_negative_low() -> None:
    slices = np.full((2, SIZE, SIZE, 3), -0.01, np.float32)
    assert np.array_equal(fit_envelope(slices, NORMALS, VALID).below(slices, NORMALS), np.zeros_like(slices))
