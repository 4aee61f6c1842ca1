from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.model import Ptm
from processing.ptm.relighting.brightest import brightest_light
from processing.ptm.relighting.diffuse_gain import gain_diffuse
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.relighting.materials import BASES, lambert, sphere_normals

GAIN = 3.0


@pytest.fixture(scope="module")
def sphere() -> Ptm:
    return lambert(sphere_normals(), colour="rgb")


def at_own_lights(ptm: Ptm, lights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Evaluate each pixel at a light of its own."""
    return np.asarray(np.einsum("hwt,thwc->hwc", PTM.evaluate(lights), ptm.coefficients))


def test_the_brightest_light_and_what_it_shows_stay(sphere: Ptm) -> None:
    before = brightest_light(sphere.coefficients.mean(axis=-1))
    gained = gain_diffuse(sphere, GAIN)
    inside = np.linalg.norm(before, axis=-1) < 0.999
    assert 0.5 < inside.mean() < 1
    assert brightest_light(gained.coefficients.mean(axis=-1))[inside] == pytest.approx(before[inside], abs=1e-4)
    assert at_own_lights(gained, before) == pytest.approx(at_own_lights(sphere, before), abs=1e-5)


def test_second_derivatives_are_scaled_and_the_slope_at_the_brightest_light_stays(sphere: Ptm) -> None:
    """By differences of pictures; where the brightest light is on the horizon, the slope there is not zero."""
    gained = gain_diffuse(sphere, GAIN)
    brightest = brightest_light(sphere.coefficients.mean(axis=-1))
    for axis in np.eye(2):
        step = 0.1 * axis
        second, scaled = (
            relight(ptm, step) + relight(ptm, -step) - 2 * relight(ptm, np.zeros(2)) for ptm in (sphere, gained)
        )
        assert scaled == pytest.approx(GAIN * second, abs=1e-5)
        slope, kept = (
            at_own_lights(ptm, brightest + step) - at_own_lights(ptm, brightest - step) for ptm in (sphere, gained)
        )
        assert kept == pytest.approx(slope, abs=1e-5)
    assert np.abs(slope).max() > 0.05


def test_a_gain_of_one_changes_nothing(sphere: Ptm) -> None:
    assert gain_diffuse(sphere, 1).coefficients == pytest.approx(sphere.coefficients, abs=1e-6)


def test_luminance_alone_is_gained_where_colour_is_apart() -> None:
    """Grey light in an LRGB material is gained as the same light in an RGB one."""
    lrgb, rgb = (
        gain_diffuse(lambert(sphere_normals(9), space="linear", colour=kind), GAIN) for kind in ("lrgb", "rgb")
    )
    light = np.array([0.2, -0.3])
    assert relight(lrgb, light) == pytest.approx(relight(rgb, light), abs=1e-4)


def test_pixels_without_a_maximum_stay_finite() -> None:
    coefficients = np.zeros((6, 1, 3, 1), np.float32)
    coefficients[:, 0, 1, 0] = [1, -1, 0.3, 0, 0, 0.5]
    coefficients[:, 0, 2, 0] = [0, 0, 0, 0.4, 0.1, 0.5]
    gained = gain_diffuse(Ptm(coefficients, np.ones((1, 3, 3), np.float32)), GAIN).coefficients
    assert np.isfinite(gained).all()
    assert gained[:, 0, [0, 2]] == pytest.approx(coefficients[:, 0, [0, 2]])  # black, and a plane: nothing to scale


@pytest.mark.parametrize("basis", [basis for basis in BASES if basis != PTM], ids=str)
def test_a_basis_without_second_derivatives_is_refused(basis: Basis, sphere: Ptm) -> None:
    other = replace(sphere, coefficients=np.zeros((basis.terms, 2, 2, 3), np.float32), basis=basis)
    with pytest.raises(InputError, match=rf"coin\.rti: is a {basis}, and diffuse gain .*--unsharp"):
        gain_diffuse(other, GAIN, "coin.rti")
