import numpy as np
import pytest
from numpy.typing import NDArray

from processing.matcap.estimate.rules import settle
from processing.matcap.estimate.signatures import Signatures

WINDOWS = np.geomspace(0.05, np.pi / 2, 80)


def signature(variances: NDArray[np.float64]) -> Signatures:
    rows = np.atleast_2d(variances)
    return Signatures("values", WINDOWS, rows, np.zeros(rows.shape), np.tile(WINDOWS, (len(rows), 1)))


def rising_to(plateau: float) -> NDArray[np.float64]:
    return plateau / (1 + (0.15 / WINDOWS) ** 4)


def test_the_plateau_is_found_between_two_rises() -> None:
    settled = settle(signature(rising_to(0.01) * (1 + np.maximum(WINDOWS - 0.8, 0) ** 2)), "plateau")
    assert settled.variances[0] == pytest.approx(0.01, rel=0.02)
    assert settled.slopes[0] < 0.02


def test_a_flat_stretch_of_windows_narrower_than_the_feature_is_no_plateau() -> None:
    variances = np.where(WINDOWS < 0.2, 0.09, 0.01 + 0.05 * (WINDOWS - 0.5) ** 2)
    assert settle(signature(variances), "plateau").variances[0] == pytest.approx(0.01, rel=0.1)


def test_noise_averages_out_over_a_plateau() -> None:
    noisy = rising_to(0.01) * np.exp(np.random.default_rng(3).normal(0, 0.002, (40, 80)))
    found = settle(signature(noisy), "plateau").variances
    assert np.std(found) < 0.002 * 0.01 / 2


def test_case_a_takes_the_minimum_behind_the_second_inflection() -> None:
    bump = 0.004 * np.exp(-(((np.log(WINDOWS) - np.log(0.35)) / 0.25) ** 2))
    growth = 0.02 * np.maximum(WINDOWS - 0.7, 0) ** 2
    variances = rising_to(0.01) + bump + growth
    lowest = np.min(variances[(WINDOWS > 0.4) & (WINDOWS < 1.2)])
    assert settle(signature(variances), "paper").variances[0] == pytest.approx(lowest, rel=0.01)


def test_case_b_takes_the_second_inflection_where_no_minimum_follows() -> None:
    variances = 0.01 * (np.tanh(8 * (np.log(WINDOWS) - np.log(0.2))) + 1) + np.exp(3 * np.log(WINDOWS)) * 0.03
    at = settle(signature(variances), "paper").at[0]
    assert 0.2 < WINDOWS[at] < 0.6


def test_case_c_takes_the_widest_window_where_nothing_bends_back() -> None:
    assert settle(signature(0.01 * np.sqrt(WINDOWS)), "paper").at[0] == 79


def test_case_d_discards_what_is_degenerate() -> None:
    settled = settle(signature(np.full(80, np.nan)), "paper")
    assert np.isnan(settled.variances[0])
    assert settled.at[0] == -1
