from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from processing.outline.circle import Circle
from processing.ptm.lights.rim import fit_rim, usual_light
from tests.processing.ptm.lights.mirror_balls import Balls, lamps


def shots(scene: Balls) -> NDArray[np.float32]:
    return np.stack([scene.picture(light, n)[..., 0] for n, light in enumerate(lamps(5))]).astype(np.float32)


def as_tuple(circle: Circle) -> tuple[float, float, float]:
    return circle.x_px, circle.y_px, circle.radius_px


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(Balls(), id="on a grey table"),
        pytest.param(Balls(background="black"), id="on velvet"),
        pytest.param(Balls(background="cloth", noise=0.001), id="on dark cloth, with noise"),
        pytest.param(Balls(distance_radii=6.0), id="from six radii"),
    ],
)
def test_a_rim_is_known_to_a_tenth_of_a_pixel(scene: Balls) -> None:
    x, y, radius = scene.outlines()[0]
    rim = fit_rim(usual_light(shots(scene)), Circle(x + 1.5, y - 2, radius * 1.05))
    assert rim is not None
    assert as_tuple(rim.circle) == pytest.approx((x, y, radius), abs=0.1)
    assert rim.agreement > 0.9


def test_an_ellipse_is_one_to_who_knows_the_camera() -> None:
    scene = Balls(balls=((250.0, 180.0, 50.0),), shape=(240, 320), distance_radii=6.0, samples=2)
    lens = CameraModel(
        width=320, height=240, focal_x_px=300, focal_y_px=300, centre_x_px=160, centre_y_px=120
    )  # fmt: skip
    x, y, radius = scene.outlines()[0]
    light = usual_light(shots(scene))
    rim = fit_rim(light, Circle(x + 1, y, radius * 0.99), lens)
    assert rim is not None
    assert as_tuple(rim.circle) == pytest.approx((x, y, radius), abs=0.2)
    blind = fit_rim(light, Circle(x + 1, y, radius * 0.99))
    assert blind is None or blind.agreement < rim.agreement


def test_brightness_does_not_matter() -> None:
    scene = Balls()
    light = usual_light(shots(scene))
    guess = Circle(71.0, 58.0, 42.5)
    bright, dark = (fit_rim(usual_light(shots(scene) * np.float32(gain)), guess) for gain in (40.0, 1e-4))
    assert bright is not None
    assert dark is not None
    first = fit_rim(light, guess)
    assert first is not None
    assert as_tuple(bright.circle) == pytest.approx(as_tuple(first.circle), abs=1e-3)
    assert as_tuple(dark.circle) == pytest.approx(as_tuple(first.circle), abs=1e-3)


def test_half_a_rim_is_enough_and_none_is_not() -> None:
    scene = replace(Balls(), background="table")
    light = usual_light(shots(scene))
    light[64:] = light[100, 80]
    rim = fit_rim(light, Circle(71.0, 58.0, 42.0))
    assert rim is not None
    assert as_tuple(rim.circle) == pytest.approx(scene.balls[0], abs=0.3)
    assert 0.3 < rim.agreement < 0.7
    assert fit_rim(np.full((120, 160), 0.1, np.float32), Circle(71.0, 58.0, 42.0)) is None
    assert fit_rim(usual_light(np.zeros((2, 120, 160), np.float32)), Circle(71.0, 58.0, 42.0)) is None
