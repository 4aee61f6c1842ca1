import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import design_matrix, fitting_matrix
from tests.processing.ptm.relief import dome


def directions(azimuths_deg: NDArray[np.floating], elevations_deg: NDArray[np.floating] | float) -> NDArray[np.float64]:
    azimuth, elevation = np.radians(azimuths_deg), np.radians(elevations_deg)
    flat = np.cos(elevation) * np.ones_like(azimuth)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation) + 0 * azimuth], axis=1)


def test_the_terms_stand_in_the_fields_order() -> None:
    assert design_matrix(np.array([[0.5, -0.2, 0.8]]))[0] == pytest.approx([0.25, 0.04, -0.1, 0.5, -0.2, 1])


def test_fitting_undoes_the_design() -> None:
    lights = dome(20)
    assert fitting_matrix(lights) @ design_matrix(lights) == pytest.approx(np.eye(6), abs=1e-10)


AROUND = np.arange(12) * 30.0


@pytest.mark.parametrize(
    ("lights", "reason"),
    [
        pytest.param(np.tile([0.0, 0.6, 0.8], (20, 1)), "1 directions cannot carry", id="all lights equal"),
        pytest.param(dome(5), "5 lights from 5 directions", id="fewer than six"),
        pytest.param(directions(AROUND, 45.0), "on one ring, 45 deg", id="one ring of elevation"),
        pytest.param(directions(AROUND, 45 + 0.01 * np.cos(AROUND)), "on one ring", id="nearly one ring"),
        pytest.param(directions(np.full(9, 30.0), np.linspace(10, 90, 9)), "in one line", id="one arc over the sample"),
        pytest.param(
            np.concatenate([directions(np.full(7, a), np.linspace(20, 80, 7)) for a in (0.0, 90.0, 180.0, 270.0)]),
            "one curve of second degree",
            id="a cross: no light tells uv",
        ),
        pytest.param(np.full((9, 3), np.nan), "not a number", id="not a number"),
    ],
)
def test_lights_that_cannot_carry_six_terms_are_refused(lights: NDArray[np.float64], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        fitting_matrix(lights)


def test_a_ring_and_the_zenith_carry_six_terms() -> None:
    lights = np.concatenate([directions(AROUND, 45.0), [[0.0, 0.0, 1.0]]])
    assert np.isfinite(fitting_matrix(lights)).all()
