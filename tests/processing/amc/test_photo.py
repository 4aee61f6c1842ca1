from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import read_linear
from processing.amc.geometry import SphereView
from processing.amc.photo import find_ball, matcap_from_photo
from processing.outline.circle import Circle
from tests.processing.amc.brushed_sphere import Scene, true_table

F32 = NDArray[np.float32]


def photograph(scene: Scene, folder: Path, ending: str = ".png") -> F32:
    return read_linear(next(scene.shoot(folder, np.array([25.0]), ending).glob(f"*{ending}")))


def as_tuple(circle: Circle) -> tuple[float, float, float]:
    return circle.x_px, circle.y_px, circle.radius_px


@pytest.mark.parametrize(
    ("scene", "ending"),
    [
        pytest.param(Scene(kind="isotropic"), ".png", id="before grey"),
        pytest.param(Scene(kind="isotropic", background="black"), ".jpg", id="before black"),
        pytest.param(Scene(background="clutter"), ".png", id="before clutter"),
        pytest.param(Scene(background="gradient", noise=0.01, distance_radii=5), ".jpg", id="near the camera"),
        pytest.param(Scene(background="limb"), ".png", id="before what is as bright as its rim"),
        pytest.param(Scene(background="white", gain=30), ".exr", id="far brighter than white"),
        pytest.param(Scene(background="grey", gain=0.02), ".exr", id="underexposed"),
        pytest.param(Scene(background="grey", blur_px=1.0), ".png", id="out of focus"),
    ],
)
def test_a_ball_is_found_in_one_photograph(scene: Scene, ending: str, tmp_path: Path) -> None:
    assert as_tuple(find_ball(photograph(scene, tmp_path, ending))) == pytest.approx(scene.circle, abs=0.4)


def test_a_matcap_that_fills_its_picture_is_a_ball(tmp_path: Path) -> None:
    scene = Scene(kind="isotropic", background="black", circle=(64, 64, 64), shape=(128, 128))
    assert as_tuple(find_ball(photograph(scene, tmp_path))) == pytest.approx(scene.circle, abs=0.5)


def dark_but_for(azimuths_deg: list[float], radius_px: float, size: int = 160) -> F32:
    """A black ball in a square black picture that mirrors a few lamps at its rim, and one in its middle."""
    y, x = np.mgrid[:size, :size] + 0.5 - size / 2
    off, azimuth = np.hypot(x, y), np.arctan2(-y, x)
    light = 0.4 * np.exp(-((x / 20) ** 2) - (y / 7) ** 2)
    for angle in np.radians(azimuths_deg):
        beside = np.angle(np.exp(1j * (azimuth - angle)))
        light = light + 0.5 * (np.abs(beside) < 0.2) * (off > 0.86 * radius_px)
    inside = np.clip(radius_px - off + 0.5, 0, 1)
    return np.repeat((light * inside)[..., None], 3, axis=-1).astype(np.float32)


def test_a_matcap_with_a_mostly_dark_rim_fills_its_picture() -> None:
    assert as_tuple(find_ball(dark_but_for([20, 200, 310], 80))) == (80, 80, 80)


@pytest.mark.parametrize(
    ("azimuths_deg", "radius_px"),
    [
        pytest.param([20, 200, 310], 72, id="light that ends before the picture does"),
        pytest.param([20, 90], 80, id="light at one side"),
        pytest.param([20, 200, 310], 84, id="light beyond the circle"),
    ],
)
def test_other_dark_pictures_are_not_taken_for_matcaps(azimuths_deg: list[float], radius_px: float) -> None:
    with pytest.raises(InputError, match="no round outline"):
        find_ball(dark_but_for(azimuths_deg, radius_px))


def test_a_photograph_without_a_ball_is_refused() -> None:
    noise = np.random.default_rng(1).uniform(0.2, 0.25, (120, 160, 3)).astype(np.float32)
    with pytest.raises(InputError, match=r"shot.jpg: no round outline.*--circle X Y R"):
        find_ball(noise, "shot.jpg")


def test_a_ball_cut_by_the_border_is_refused(tmp_path: Path) -> None:
    scene = Scene(kind="isotropic", circle=(50.3, 77.8, 60.4))
    with pytest.raises(InputError, match=r"cut by the border"):
        find_ball(photograph(scene, tmp_path))


def test_a_black_picture_is_refused() -> None:
    with pytest.raises(InputError, match=r"no round outline"):
        find_ball(np.zeros((90, 90, 3), np.float32))


def test_the_table_is_what_the_normals_look_like(tmp_path: Path) -> None:
    scene = Scene(kind="isotropic")
    made = matcap_from_photo(photograph(scene, tmp_path), Circle(*scene.circle), SphereView(), 48)
    truth, radius = true_table("isotropic", 48, np.array([0.0]))
    away = radius < 0.9
    assert np.abs(made.colours - truth[0])[away].max() < 0.02
    assert made.valid[radius < 0.93].all()
    assert not made.valid[radius > 1.05].any()


def test_colours_go_on_beyond_the_disc(tmp_path: Path) -> None:
    scene = Scene(kind="isotropic", background="white")
    made = matcap_from_photo(photograph(scene, tmp_path), Circle(*scene.circle), SphereView(), 32)
    corner, inside = made.colours[0, 0], made.colours[made.valid]
    assert np.abs(inside - corner).sum(axis=1).min() < 1e-6


def test_colours_beyond_white_are_kept(tmp_path: Path) -> None:
    scene = Scene(kind="isotropic", gain=30)
    made = matcap_from_photo(photograph(scene, tmp_path, ".exr"), Circle(*scene.circle), SphereView(), 32)
    assert made.colours.dtype == np.float32
    assert made.colours.max() > 10
