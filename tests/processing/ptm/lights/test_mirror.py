"""Reflections in a ball, against rays traced from a point on it."""

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.errors import InputError
from processing.outline.circle import Circle
from processing.ptm.lights.mirror import Mirror, camera_at
from tests.processing.ptm.lights.mirror_balls import Balls

F64 = NDArray[np.float64]


def seen_points(centre: F64, toward: F64 | None, count: int = 60) -> F64:
    """Unit normals of points of a ball around `centre` that the origin sees, or that are seen along `toward`."""
    normals = np.random.default_rng(3).standard_normal((20 * count, 3))
    normals = np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True), np.float64)
    to_eye = -(centre + normals) if toward is None else np.broadcast_to(toward, normals.shape)
    seen: F64 = normals[np.sum(normals * to_eye, axis=1) > 0.02 * np.linalg.norm(to_eye, axis=1)][:count]
    return seen


def camera(focal_px: float) -> CameraModel:
    return CameraModel(
        width=160, height=120, focal_x_px=focal_px, focal_y_px=focal_px, centre_x_px=81.5, centre_y_px=57.25
    )


def test_an_orthographic_ball_mirrors_by_the_law_of_reflection() -> None:
    z = np.array([0.0, 0.0, 1.0])
    normals = seen_points(np.zeros(3), z)
    places = np.array([50.25, 60.5]) + 40 * normals[:, :2] * [1, -1]
    mirrored = 2 * normals[:, 2:] * normals - z
    np.testing.assert_allclose(Mirror(Circle(50.25, 60.5, 40.0)).directions(places), mirrored, atol=1e-9)


@pytest.mark.parametrize("distance_radii", [3.0, 8.0, 50.0])
def test_a_ball_on_the_axis_mirrors_along_each_ray(distance_radii: float) -> None:
    focal_px = 40 * np.sqrt(distance_radii**2 - 1)
    centre = np.array([0.0, 0.0, -distance_radii])
    normals = seen_points(centre, None)
    points = centre + normals
    places = np.stack(
        [81.5 - focal_px * points[:, 0] / points[:, 2], 57.25 + focal_px * points[:, 1] / points[:, 2]], 1
    )
    rays = points / np.linalg.norm(points, axis=1, keepdims=True)
    mirrored = rays - 2 * np.sum(rays * normals, axis=1, keepdims=True) * normals
    ball = Mirror(Circle(81.5, 57.25, 40.0), camera(focal_px))
    assert ball.distance_radii == pytest.approx(distance_radii)
    np.testing.assert_allclose(ball.directions(places), mirrored, atol=1e-7)


def test_a_ball_off_the_axis_is_placed_by_its_ellipse() -> None:
    scene = Balls(balls=((120.0, 88.0, 25.0),), distance_radii=10.0)
    lens = CameraModel(width=160, height=120, focal_x_px=250.0, focal_y_px=250.0, centre_x_px=80.0, centre_y_px=60.0)
    centre = np.array([40.0, -28.0, -250.0]) / 25
    normals = seen_points(centre, None)
    points = centre + normals
    places = np.stack([80 - 250 * points[:, 0] / points[:, 2], 60 + 250 * points[:, 1] / points[:, 2]], 1)
    rays = points / np.linalg.norm(points, axis=1, keepdims=True)
    mirrored = rays - 2 * np.sum(rays * normals, axis=1, keepdims=True) * normals
    ball = Mirror(Circle(*scene.outlines()[0]), lens)
    assert ball.distance_radii == pytest.approx(np.linalg.norm(centre), rel=5e-4)
    inner = ball.facing(places) > 0.3
    off_deg = np.degrees(np.arccos(np.clip(np.sum(ball.directions(places) * mirrored, axis=1), -1, 1)))
    assert off_deg[inner].max() < 0.1


def test_the_middle_mirrors_the_camera_and_the_rim_what_is_behind() -> None:
    ball = Mirror(Circle(50.0, 60.0, 40.0))
    places = np.array([[50.0, 60.0], [90.0, 60.0], [50.0 + 40 / np.sqrt(2), 60.0]])
    np.testing.assert_allclose(ball.directions(places), [[0, 0, 1], [0, 0, -1], [1, 0, 0]], atol=1e-9)
    np.testing.assert_allclose(ball.facing(places), [1, 0, np.sqrt(0.5)], atol=1e-9)


@pytest.mark.parametrize("circle", [Circle(80, 60, 30), Circle(130, 95, 18)], ids=["on the axis", "far off it"])
def test_a_camera_at_a_distance_sees_the_ball_from_there(circle: Circle) -> None:
    lens = camera_at(7.0, circle, (120, 160))
    assert (lens.centre_x_px, lens.centre_y_px) == (80, 60)
    assert Mirror(circle, lens).distance_radii == pytest.approx(7.0)


@pytest.mark.parametrize("distance_radii", [0.5, 1.0, float("nan"), 1e9])
def test_a_camera_cannot_stand_just_anywhere(distance_radii: float) -> None:
    with pytest.raises(InputError, match=r"cannot stand .* radii.*measure again"):
        camera_at(distance_radii, Circle(80, 60, 30), (120, 160))
