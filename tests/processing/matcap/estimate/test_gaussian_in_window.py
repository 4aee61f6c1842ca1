import math

import numpy as np
import pytest
from scipy import integrate

from processing.matcap.estimate.gaussian_in_window import gaussian_behind


def moments(mean: float, variance: float, begin: float, end: float) -> tuple[float, float]:
    """Mean and variance of a Gaussian under the window on [begin, end], by adaptive quadrature."""

    def part(power: int) -> float:
        def density(u: float) -> float:
            return u**power * math.exp(-4.5 * u**2 - (u - mean) ** 2 / (2 * variance))

        return float(integrate.quad(density, begin, end, epsabs=1e-14, epsrel=1e-12, limit=400)[0])

    energy, first, second = part(0), part(1), part(2)
    return first / energy, second / energy - (first / energy) ** 2


@pytest.mark.parametrize(
    ("mean", "variance", "begin", "end"),
    [
        (0.0, 0.04, -1.0, 1.0),
        (0.0, 0.7, -1.0, 1.0),
        (0.2, 0.1, -1.0, 1.0),
        (0.0, 0.2, -1.0, 0.15),
        (-0.1, 0.3, -0.3, 1.0),
        (0.02, 0.003, -1.0, 1.0),
    ],
)
def test_a_gaussian_is_found_behind_a_window_with_ends(mean: float, variance: float, begin: float, end: float) -> None:
    seen = moments(mean, variance, begin, end)
    found = gaussian_behind(*(np.array([part]) for part in (*seen, begin, end)))
    assert found[0][0] == pytest.approx(mean, abs=1e-6)
    assert found[1][0] == pytest.approx(variance, rel=1e-6)


def test_what_is_as_flat_as_the_window_has_no_gaussian_behind_it() -> None:
    flat = np.array([1 / 9])
    _, variance = gaussian_behind(np.zeros(1), flat, -np.ones(1), np.ones(1))
    assert np.isnan(variance[0])


def test_moments_that_nothing_in_the_window_has_are_refused() -> None:
    _, variance = gaussian_behind(np.array([0.0, 2.0, np.nan]), np.array([1.5, 0.1, 0.1]), -np.ones(3), np.ones(3))
    assert np.isnan(variance).all()
