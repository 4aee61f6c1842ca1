import numpy as np
import pytest

from processing.amc.harmonics import fit_harmonics
from processing.amc.invariance import InvarianceReport, find_invariance

RANDOM = np.random.default_rng(3)


def report_on(repeats: int | None, noise: float = 0.004, count: int = 48, threshold: float = 0.05) -> InvarianceReport:
    """Slices of 50 texels around 0.5 that repeat so often in a turn; None: not varying at all."""
    angles = 2 * np.pi * np.arange(count) / count
    phases = RANDOM.uniform(0, 2 * np.pi, (50, 3))
    peaks = 0 if repeats is None else 0.2 * np.exp(2 * np.cos(repeats * (angles[:, None, None] - phases)) - 2)
    slices = 0.5 + peaks + noise * RANDOM.standard_normal((count, 50, 3))
    harmonics = fit_harmonics(slices.astype(np.float32), angles, (count - 1) // 2)
    return find_invariance(harmonics, harmonics, threshold)


@pytest.mark.parametrize("repeats", [1, 2, 3, 4])
@pytest.mark.parametrize("noise", [0.0, 0.004, 0.02])
def test_the_largest_consistent_invariance_is_found(repeats: int, noise: float) -> None:
    assert report_on(repeats, noise).found == repeats


@pytest.mark.parametrize("noise", [0.0, 0.004, 0.02])
def test_what_does_not_change_is_isotropic(noise: float) -> None:
    assert report_on(None, noise).found == "isotropic"


def test_an_invariance_of_three_is_found_among_128_slices() -> None:
    assert report_on(3, count=128).found == 3


def test_the_noise_of_a_harmonic_is_estimated() -> None:
    """White noise σ in N slices leaves σ·√(2/N) RMS in each harmonic."""
    assert report_on(2, 0.02).noise == pytest.approx(0.02 * np.sqrt(2 / 48), rel=0.1)


def test_a_rotation_that_the_material_keeps_differs_by_noise_alone() -> None:
    evidence = report_on(2, 0.01).of(2)
    assert evidence is not None
    assert evidence.rotation_rms == pytest.approx(0.01 * np.sqrt(2), rel=0.1)
    assert evidence.over_noise == pytest.approx(1, rel=0.1)


def test_a_rotation_that_it_does_not_keep_differs_by_what_is_seen() -> None:
    """A cosine of amplitude a turned by a quarter of its period differs by a RMS."""
    harmonics = np.zeros((8, 6, 3), np.complex64)
    harmonics[0], harmonics[1] = 1, 0.3
    evidence = find_invariance(harmonics, harmonics).of(4)
    assert evidence is not None
    assert evidence.rotation_rms == pytest.approx(0.3)


@pytest.mark.parametrize(("threshold", "found"), [(0.001, 1), (0.2, 2)])
def test_the_threshold_decides_what_is_usable(threshold: float, found: int) -> None:
    harmonics = np.zeros((24, 6, 3), np.complex64)
    harmonics[0], harmonics[1], harmonics[2] = 1, 0.05, 0.3
    assert find_invariance(harmonics, harmonics, threshold).found == found


def test_the_rotation_curve_touches_noise_where_the_material_comes_back() -> None:
    report = report_on(2, 0.01)
    kept, turned = report.rotation_difference(np.array([180.0, 90.0]))
    assert kept == pytest.approx(0.01 * np.sqrt(2), rel=0.1)
    assert turned > 5 * kept
    evidence = report.of(4)
    assert evidence is not None
    assert turned == pytest.approx(evidence.rotation_rms)
