import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmware_sim.config import SphereScene
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import F32, Pose

SIZE = (240, 320)
CENTRED = SphereScene(centre_x_px=320, centre_y_px=240)
"""The sphere in the middle of the picture, so that a picture can be turned about it."""


def view(scene: BrushedSphere, *angles_deg: float, size: tuple[int, int] = SIZE) -> F32:
    return scene.light([Pose(angle_deg, 0, 0, 0) for angle_deg in angles_deg], size)


def inside(size: tuple[int, int] = SIZE, radius: float = 0.9) -> np.ndarray:
    rows, columns = np.mgrid[0 : size[0], 0 : size[1]] + 0.5
    off = np.hypot(columns - size[1] / 2, rows - size[0] / 2) / (180 * size[0] / 480)
    return np.asarray(off < radius)


def streak_direction_deg(picture: F32) -> float:
    """Return the direction along which the sphere's picture changes least, 0..180, from x towards y (up)."""
    grey = picture.mean(2).astype(np.float32)
    down, right = np.gradient(cv2.GaussianBlur(grey, (0, 0), 1.5))
    mask = inside(radius=0.75)
    xx, yy, xy = (right**2)[mask].sum(), (down**2)[mask].sum(), (-right * down)[mask].sum()
    steepest = 0.5 * np.arctan2(2 * xy, xx - yy)
    return float(np.degrees(steepest) + 90) % 180


@settings(max_examples=10, deadline=None)
@given(st.floats(-400, 400))
def test_half_a_turn_brings_the_same_picture(angle_deg: float) -> None:
    scene = BrushedSphere(CENTRED)
    np.testing.assert_allclose(view(scene, angle_deg), view(scene, angle_deg + 180), atol=2e-4)


def test_a_quarter_turn_does_not() -> None:
    scene = BrushedSphere(CENTRED)
    assert np.abs(view(scene, 0) - view(scene, 90))[inside()].mean() > 0.05


def test_highlights_stretch_across_the_brushing_and_turn_counter_clockwise() -> None:
    scene = BrushedSphere(CENTRED)
    at_rest, turned = (streak_direction_deg(view(scene, angle)) for angle in (0, 40))
    assert at_rest == pytest.approx(90, abs=20)  # the tangent lies along x, the highlight across it
    assert (turned - at_rest) % 180 == pytest.approx(40, abs=20)


def test_the_tangent_at_zero_is_a_turn_ahead() -> None:
    ahead = BrushedSphere(CENTRED.model_copy(update={"tangent_zero_deg": 30.0}))
    np.testing.assert_allclose(view(ahead, 10), view(BrushedSphere(CENTRED), 40), atol=1e-5)


def test_an_isotropic_sphere_does_not_change_as_it_turns() -> None:
    scene = BrushedSphere(CENTRED.model_copy(update={"roughness_along": 0.3, "roughness_across": 0.3}))
    np.testing.assert_allclose(view(scene, 0), view(scene, 77), atol=1e-5)


def test_the_background_does_not_turn() -> None:
    scene = BrushedSphere(CENTRED)
    outside = ~inside(radius=1.02)
    np.testing.assert_array_equal(view(scene, 0)[outside], view(scene, 123)[outside])


def test_the_sphere_lies_where_the_configuration_says_at_every_size() -> None:
    scene = BrushedSphere(SphereScene())
    for size, scale in (((480, 640), 1.0), ((240, 320), 0.5)):
        changed = np.abs(view(scene, 0, size=size) - view(scene, 90, size=size)).max(2) > 1e-4
        rows, columns = np.nonzero(changed)
        centre = (columns.min() + columns.max() + 1) / 2, (rows.min() + rows.max() + 1) / 2
        expected = size[1] / 2 + 4.3 * scale, size[0] / 2 - 1.4 * scale
        assert centre == pytest.approx(expected, abs=1.5)
        assert (columns.max() - columns.min() + 1) / 2 == pytest.approx(180 * scale, abs=1.5)


def test_a_near_camera_sees_less_of_the_sphere_than_a_far_one() -> None:
    pictures = {
        "near": view(BrushedSphere(CENTRED.model_copy(update={"distance_radii": 2.0})), 0),
        "far": view(BrushedSphere(CENTRED.model_copy(update={"distance_radii": 1000.0})), 0),
        "orthographic": view(BrushedSphere(CENTRED.model_copy(update={"projection": "orthographic"})), 0),
    }
    assert np.abs(pictures["far"] - pictures["orthographic"])[inside()].max() < 0.03
    assert np.abs(pictures["near"] - pictures["orthographic"])[inside()].max() > 0.2


def test_a_moving_picture_is_the_mean_of_its_instants() -> None:
    scene = BrushedSphere(CENTRED)
    moving = view(scene, 10, 14, 18, 22)
    still = np.mean([view(scene, angle) for angle in (10, 14, 18, 22)], axis=0)
    assert np.abs(moving - still).max() < 0.03
    assert np.abs(moving - view(scene, 10))[inside()].max() > 0.05


def test_nothing_is_brighter_than_a_few_pixels_can_hold() -> None:
    picture = view(BrushedSphere(SphereScene()), 20, size=(480, 640))
    assert picture.min() >= 0
    assert np.mean(picture.max(2) > 1) < 0.002
    assert np.quantile(picture[inside((480, 640))], 0.99) > 0.4
