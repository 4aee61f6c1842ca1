from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.outline.circle import Circle
from processing.outline.orbit import Orbit, Outline, find_outline, fit_orbit
from processing.stack import Stack
from tests.processing.amc.brushed_sphere import Scene

F64 = NDArray[np.float64]

ANGLES_DEG: F64 = np.linspace(11.0, 326.0, 8)


def small(**changes: Any) -> Scene:
    return Scene(**{"circle": (63.3, 57.8, 45.4), "shape": (116, 128)} | changes)


def outline(scene: Scene, folder: Path) -> Outline:
    return find_outline(stack(scene, folder), np.radians(ANGLES_DEG))


def stack(scene: Scene, folder: Path) -> Stack:
    return Stack(sorted(scene.shoot(folder, ANGLES_DEG).glob("*.png")))


def as_tuple(circle: Circle) -> tuple[float, float, float]:
    return circle.x_px, circle.y_px, circle.radius_px


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(small(offset_px=2.7, phase_deg=200, background="white"), id="as far as eight pixels of 180"),
        pytest.param(small(offset_px=0.5, phase_deg=-50, noise=0.01), id="half a pixel, in noise"),
        pytest.param(small(offset_px=1.5, phase_deg=95, background="clutter"), id="before clutter"),
        pytest.param(small(offset_px=1.5, phase_deg=10, plate="all over"), id="with a board that turns along"),
    ],
)
def test_an_offset_is_measured_and_followed_round(scene: Scene, tmp_path: Path) -> None:
    found = outline(scene, tmp_path)
    assert found.orbit.offset_px == pytest.approx(scene.offset_px, abs=0.15)
    assert as_tuple(found.circle) == pytest.approx(scene.circle, abs=0.3)
    for angle_deg in (0.0, 77.0, 250.0):
        circle = found.circle_at(np.radians(angle_deg))
        assert as_tuple(circle) == pytest.approx(scene.circle_at(angle_deg), abs=0.3)


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(small(noise=0.01), id="one that turns in its place"),
        pytest.param(small(kind="1", background="clutter"), id="before clutter"),
    ],
)
def test_a_centred_sphere_gets_no_orbit(scene: Scene, tmp_path: Path) -> None:
    found = outline(scene, tmp_path)
    assert found.orbit.offset_px == 0
    assert found.circle_at(1.0) == found.circle
    assert found.orbit.remark() is None


def test_what_no_orbit_explains_is_called_a_wobble(tmp_path: Path) -> None:
    scene = small(background="white", wobble_px=1.0)
    found = outline(scene, tmp_path)
    assert found.orbit.left_over_px == pytest.approx(1.0, abs=0.2)
    assert "wobbles by 1 px" in str(found.orbit.remark()) or "wobbles by 0.9" in str(found.orbit.remark())
    assert as_tuple(found.circle) == pytest.approx(scene.circle, abs=0.3)


def test_angles_and_pictures_must_be_as_many(tmp_path: Path) -> None:
    shots = stack(small(samples=1), tmp_path)
    with pytest.raises(InputError, match=r"8 pictures and 7 angles"):
        find_outline(shots, np.radians(ANGLES_DEG[:-1]))


def test_the_offset_goes_round_counter_clockwise_in_pictures_whose_y_runs_down() -> None:
    orbit = Orbit(100, 100, 5, 0, 40, 0, 0)
    assert as_tuple(orbit.circle_at(np.pi / 2)) == pytest.approx((100, 95, 40))


@given(
    axis=st.tuples(st.floats(-50, 500), st.floats(-50, 500)),
    offset_px=st.floats(0.2, 30),
    phase_rad=st.floats(-3, 3),
    zero_rad=st.floats(0, 6),
)
def test_an_exact_orbit_is_fitted_exactly_whatever_one_picture_says(
    axis: tuple[float, float], offset_px: float, phase_rad: float, zero_rad: float
) -> None:
    angles = zero_rad + np.linspace(0, 2 * np.pi, 16, endpoint=False)
    true = Orbit(*axis, offset_px, phase_rad, 60, 0, 0)
    centres = np.array([as_tuple(true.circle_at(angle))[:2] for angle in angles])
    centres[5] += 40
    fitted = fit_orbit(centres, angles, 60)
    assert as_tuple(fitted.circle_at(0.3)) == pytest.approx(as_tuple(true.circle_at(0.3)), abs=1e-3)
    assert fitted.offset_px == pytest.approx(offset_px, abs=1e-3)


def test_scatter_alone_is_no_orbit() -> None:
    random = np.random.default_rng(4)
    angles = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    fitted = [fit_orbit(random.normal(0, 0.4, (16, 2)), angles, 60) for _ in range(50)]
    assert sum(orbit.offset_px > 0 for orbit in fitted) <= 2
