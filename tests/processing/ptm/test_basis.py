import numpy as np
import pytest
from numpy.typing import NDArray

from processing.ptm.basis import PTM, TERMS, Basis, Kind
from tests.processing.ptm.relief import dome

ALL = [Basis(kind, terms) for kind, numbers in TERMS.items() for terms in numbers]


def test_the_terms_stand_in_the_fields_order() -> None:
    assert PTM.evaluate(np.array([[0.5, -0.2, 0.8]]))[0] == pytest.approx([0.25, 0.04, -0.1, 0.5, -0.2, 1])
    assert Basis("ptm", 3).evaluate(np.array([0.5, -0.2])) == pytest.approx([0.5, -0.2, 1])


def half_sphere() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions and weights that integrate over the half-sphere."""
    node, weight = np.polynomial.legendre.leggauss(200)
    z, azimuth = (node + 1) / 2, 2 * np.pi * np.arange(64) / 64
    flat = np.sqrt(1 - z * z)[:, None]
    directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), z[:, None] + 0 * azimuth], axis=-1)
    return directions.reshape(-1, 3), np.repeat(weight / 2 * 2 * np.pi / 64, 64)


@pytest.mark.parametrize("terms", [4, 9, 16])
def test_hemispherical_harmonics_are_orthonormal(terms: int) -> None:
    directions, weight = half_sphere()
    values = Basis("hsh", terms).evaluate(directions)
    assert (values * weight[:, None]).T @ values == pytest.approx(
        np.eye(terms), abs=0.01
    )  # but for the field's margin at the horizon


def test_each_harmonic_is_what_the_format_says() -> None:
    """The nine functions of `.rti` files, one by one, at a direction without symmetry."""
    theta, phi = 0.7, 0.4
    c, pi, cos, sin, sqrt = np.cos(theta), np.pi, np.cos, np.sin, np.sqrt
    q = sqrt(c - c * c)
    expected = [
        1 / sqrt(2 * pi),
        sqrt(6 / pi) * cos(phi) * q,
        sqrt(3 / (2 * pi)) * (2 * c - 1),
        sqrt(6 / pi) * sin(phi) * q,
        sqrt(30 / pi) * cos(2 * phi) * (c * c - c),
        sqrt(30 / pi) * cos(phi) * (2 * c - 1) * q,
        sqrt(5 / (2 * pi)) * (1 - 6 * c + 6 * c * c),
        sqrt(30 / pi) * sin(phi) * (2 * c - 1) * q,
        sqrt(30 / pi) * sin(2 * phi) * (c * c - c),
    ]
    light = np.array([sin(theta) * cos(phi), sin(theta) * sin(phi), c])
    assert Basis("hsh", 16).evaluate(light)[:9] == pytest.approx(expected)


@pytest.mark.parametrize("basis", ALL, ids=str)
def test_the_gram_is_the_mean_over_the_disc(basis: Basis) -> None:
    directions = dome(40_000, 0.6)
    weight = directions[:, 2]  # the disc is the half-sphere seen from above
    values = basis.evaluate(directions)
    mean = (values * weight[:, None]).T @ values / weight.sum()
    assert basis.gram == pytest.approx(mean, abs=2e-3)


@pytest.mark.parametrize("basis", ALL, ids=str)
def test_two_numbers_are_a_direction_too(basis: Basis) -> None:
    lights = dome(7)
    assert basis.evaluate(lights[:, :2]) == pytest.approx(basis.evaluate(lights), abs=1e-9)
    assert len(basis.names) == basis.terms


@pytest.mark.parametrize(("kind", "terms"), [("ptm", 5), ("hsh", 6)])
def test_other_numbers_of_terms_are_refused(kind: Kind, terms: int) -> None:
    with pytest.raises(ValueError, match="terms"):
        Basis(kind, terms)
