import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.conditioning import fitting_matrix
from tests.processing.ptm.relief import dome


def directions(azimuths_deg: NDArray[np.floating], elevations_deg: NDArray[np.floating] | float) -> NDArray[np.float64]:
    azimuth, elevation = np.radians(azimuths_deg), np.radians(elevations_deg)
    flat = np.cos(elevation) * np.ones_like(azimuth)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation) + 0 * azimuth], axis=1)


def test_fitting_undoes_the_design() -> None:
    lights = dome(20)
    assert fitting_matrix(PTM, lights) @ PTM.evaluate(lights) == pytest.approx(np.eye(6), abs=1e-10)


AROUND = np.arange(12) * 30.0


@pytest.mark.parametrize(
    ("lights", "reason"),
    [
        pytest.param(np.tile([0.0, 0.6, 0.8], (20, 1)), "1 direction, which cannot carry", id="all lights equal"),
        pytest.param(dome(5), "5 lights from 5 directions", id="fewer than six"),
        pytest.param(directions(AROUND, 45.0), "on one ring, 45 deg", id="one ring of elevation"),
        pytest.param(directions(AROUND, 45 + 0.01 * np.cos(AROUND)), "on one ring", id="nearly one ring"),
        pytest.param(directions(np.full(9, 30.0), np.linspace(10, 90, 9)), "in one line", id="one arc over the sample"),
        pytest.param(
            np.concatenate([directions(np.full(7, a), np.linspace(20, 80, 7)) for a in (0.0, 90.0, 180.0, 270.0)]),
            "one curve",
            id="a cross: no light tells uv",
        ),
        pytest.param(np.full((9, 3), np.nan), "not a number", id="not a number"),
    ],
)
def test_lights_that_cannot_carry_six_terms_are_refused(lights: NDArray[np.float64], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        fitting_matrix(PTM, lights)


def test_a_ring_and_the_zenith_carry_six_terms() -> None:
    lights = np.concatenate([directions(AROUND, 45.0), [[0.0, 0.0, 1.0]]])
    assert np.isfinite(fitting_matrix(PTM, lights)).all()


@pytest.mark.parametrize("basis", [Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9), Basis("hsh", 16)], ids=str)
def test_every_basis_is_carried_by_a_dome(basis: Basis) -> None:
    lights = dome(40)
    assert fitting_matrix(basis, lights) @ basis.evaluate(lights) == pytest.approx(np.eye(basis.terms), abs=1e-9)


def test_a_ring_carries_the_polynomial_of_first_degree() -> None:
    assert np.isfinite(fitting_matrix(Basis("ptm", 3), directions(AROUND, 45.0))).all()


def test_few_lights_do_when_coefficients_are_held_down() -> None:
    lights = dome(4)
    solver = fitting_matrix(PTM, lights, ridge=0.01)
    flat = solver @ np.full(4, 0.5)
    assert flat @ PTM.evaluate(dome(9)).T == pytest.approx(np.full(9, 0.5), abs=0.02)


def test_lights_that_are_all_alike_are_refused_whatever_holds_coefficients_down() -> None:
    with pytest.raises(InputError, match="1 direction"):
        fitting_matrix(PTM, np.tile([0.0, 0.6, 0.8], (20, 1)), ridge=0.1)
