import math

import pytest

from processing.matcap.filter import MATT_FILTER_SIZE, slope_of


@pytest.mark.parametrize(("filter_size", "slope"), [(0.0, 1.0), (0.1, 0.959), (0.5, 0.575), (0.827, 0.0)])
def test_the_slope_follows_the_papers_polynomial(filter_size: float, slope: float) -> None:
    assert slope_of(filter_size) == pytest.approx(slope, abs=5e-4)


def test_a_slope_is_never_negative() -> None:
    assert slope_of(3.0) == 0


def test_the_matt_filter_is_a_clamped_cosine() -> None:
    assert pytest.approx(math.pi**2 / 4 - 2, abs=1e-6) == MATT_FILTER_SIZE
