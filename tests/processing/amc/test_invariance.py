import numpy as np
import pytest

from processing.amc.geometry import texel_plane
from processing.amc.harmonics import check_angles, fit_harmonics
from processing.amc.invariance import InvarianceReport, find_invariance
from processing.amc.noise import noise_variance
from processing.amc.probe import make_probe
from processing.amc.shots import Slices
from processing.amc.table import Series
from processing.amc.tangent_turn import TangentTurn
from processing.room import Room
from tests.processing.amc.random_materials import Trial, make_trial

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


def test_the_noise_of_a_texel_is_estimated() -> None:
    assert report_on(2, 0.02).noise == pytest.approx(0.02, rel=0.1)


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


def test_more_is_tried_when_asked_for() -> None:
    angles = 2 * np.pi * np.arange(48) / 48
    slices = (0.5 + 0.2 * np.cos(6 * angles))[:, None, None] * np.ones((1, 50, 3))
    harmonics = fit_harmonics(slices.astype(np.float32), angles, 23)
    assert find_invariance(harmonics, harmonics).found == 3
    assert find_invariance(harmonics, harmonics, most_repeats=6).found == 6


def test_eight_slices_do_not_tell_four_repeats_from_none() -> None:
    """Their series ends at the third harmonic."""
    flat = np.zeros((4, 50, 3), np.complex64)
    flat[0] = 0.5
    assert find_invariance(flat, flat).found == "cannot tell"
    assert find_invariance(flat, flat, most_repeats=3).found == "isotropic"


def test_regions_that_disagree_lower_the_confidence() -> None:
    """Two thirds of the sphere repeat twice a turn, a third does not by far."""
    harmonics = np.zeros((24, 60, 3), np.complex64)
    harmonics[0], harmonics[2] = 1, 0.3
    alike = find_invariance(harmonics, harmonics, regions=np.arange(60) // 5)
    harmonics[1, :20] = 0.1
    mixed = find_invariance(harmonics, harmonics, regions=np.arange(60) // 5)
    assert (alike.found, alike.confidence) == (2, 1.0)
    assert 0.3 < mixed.confidence < 0.95


KINDS = (1, 2, 3, 4, "isotropic")


def report_on_trial(trial: Trial) -> InvarianceReport:
    n_x, n_y = texel_plane(len(trial.valid))
    normal_z = np.sqrt(np.maximum(1 - n_x**2 - n_y**2, 0))
    turn = TangentTurn(normal_z, normal_z, np.arctan2(n_y, n_x))
    series = Series(trial.angles_rad, check_angles(trial.angles_rad, "trial"))
    probe = make_probe(Slices(Room(trial.slices), trial.valid, turn, 36.0), series)
    noise = float(np.sqrt(noise_variance(trial.slices, trial.valid)))
    return find_invariance(probe.harmonics(), probe.upright().harmonics(), noise=noise, regions=probe.regions)


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_no_verdict_is_wrong_where_the_change_stands_out_and_none_is_given_where_it_does_not(
    kind: int | str,
) -> None:
    """Forty random lights, roughnesses and noises of 8-bit pictures each."""
    told = 0
    for seed in range(40):
        trial = make_trial(kind, 5000 + seed)
        found = report_on_trial(trial).found
        if kind == "isotropic" or trial.energy_over_noise >= 3:
            assert found == kind, f"seed {seed}: {trial.energy_over_noise}"
            told += 1
        elif trial.energy_over_noise < 2:
            nothing = "isotropic" if trial.variation < 0.01 else "cannot tell"
            assert found in ("cannot tell", nothing), f"seed {seed}: {trial.energy_over_noise}"
    assert told > 25


def test_128_slices_show_three_repeats() -> None:
    assert report_on_trial(make_trial(3, 4, slices=128)).found == 3


def test_the_rotation_curve_touches_noise_where_the_material_comes_back() -> None:
    report = report_on(2, 0.01)
    kept, turned = report.rotation_difference(np.array([180.0, 90.0]))
    assert kept == pytest.approx(0.01 * np.sqrt(2), rel=0.1)
    assert turned > 5 * kept
    evidence = report.of(4)
    assert evidence is not None
    assert turned == pytest.approx(evidence.rotation_rms)
