import numpy as np
import pytest

from processing.ptm.basis import PTM
from processing.ptm.relighting.brightest import brightest_light


def test_nothing_on_the_disc_is_brighter() -> None:
    """Against the largest of many lights, for polynomials with and without a maximum of their own."""
    polynomials = np.random.default_rng(7).standard_normal((6, 400))
    polynomials[:2, ::2] = -np.abs(polynomials[:2, ::2]) - 1
    found = brightest_light(polynomials)
    radius = np.linalg.norm(found, axis=-1)
    assert 40 < np.count_nonzero(radius < 0.999) < 360
    assert radius.max() <= 1 + 1e-9
    r, angle = np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 2 * np.pi, 721))
    disc = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1).reshape(-1, 2)
    largest = np.max(PTM.evaluate(disc) @ polynomials, axis=0)
    values = np.einsum("pt,tp->p", PTM.evaluate(found), polynomials)
    assert np.all(values >= largest - 1e-6)
    assert values == pytest.approx(largest, abs=0.01)


@pytest.mark.parametrize(
    ("polynomial", "light"),
    [
        pytest.param([-1, -1, 0, 0.6, -0.8, 0], [0.3, -0.4], id="a peak inside"),
        pytest.param([-1, -1, 0, 3, 4, 0], [0.6, 0.8], id="a peak beyond the horizon: the circle"),
        pytest.param([1, 1, 0, 0.1, 0, 0], [1, 0], id="a bowl"),
        pytest.param([0.5, -0.5, 0, 0, 0.1, 0], [np.sqrt(1 - 0.05**2), 0.05], id="a saddle: one of two alike"),
        pytest.param([0, 0, 0, 0, -1, 0], [0, -1], id="a plane"),
    ],
)
def test_the_brightest_light(polynomial: list[float], light: list[float]) -> None:
    found = brightest_light(np.array(polynomial)[:, None])[0]
    assert [abs(found[0]), found[1]] if polynomial[0] == 0.5 else list(found) == pytest.approx(light, abs=1e-6)


def test_a_pixel_that_is_always_black_has_one_too() -> None:
    assert np.linalg.norm(brightest_light(np.zeros((6, 1)))) <= 1 + 1e-9
