"""How an object is turned and framed."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from viewer.view import Projection, View

angles_deg = st.floats(-400, 400)
sides_px = st.integers(1, 3000)


def project(view: View, points: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
    """Object-frame points to clip space divided by w."""
    camera = view.camera(size)
    in_view = points @ camera.view_from_object.T
    clip = np.concatenate([in_view, np.ones((len(points), 1))], axis=1) @ camera.clip_from_view.T
    assert np.all(clip[:, 3] > 0)
    return clip[:, :3] / clip[:, 3:]


@given(
    projection=st.sampled_from(Projection),
    yaw_deg=angles_deg,
    pitch_deg=angles_deg,
    fov_deg=st.floats(1, 120),
    size=st.tuples(sides_px, sides_px),
    point=st.tuples(*[st.floats(-0.57, 0.57)] * 3),
)
def test_the_unit_sphere_is_always_whole_in_the_picture(
    projection: Projection,
    yaw_deg: float,
    pitch_deg: float,
    fov_deg: float,
    size: tuple[int, int],
    point: tuple[float, float, float],
) -> None:
    placed = project(View(projection, yaw_deg, pitch_deg, fov_deg), np.array([point]), size)
    assert np.all(np.abs(placed) <= 1)


@pytest.mark.parametrize("projection", Projection)
def test_pixels_are_square(projection: Projection) -> None:
    right, up = project(View(projection), np.array([[0.5, 0, 0], [0, 0.5, 0]]), (300, 200))[[0, 1], [0, 1]]
    assert right * 300 == pytest.approx(up * 200)


@pytest.mark.parametrize(
    ("view", "moves", "to"),
    [
        pytest.param(View(yaw_deg=90), (0, 0, 1), (1, 0, 0), id="yaw brings the front to the right"),
        pytest.param(View(pitch_deg=90), (0, 1, 0), (0, 0, 1), id="pitch brings the top to the front"),
        pytest.param(
            View(yaw_deg=90, pitch_deg=90), (1, 0, 0), (0, 1, 0), id="yaw first: the right goes back, then up"
        ),
        pytest.param(View(roll_deg=90), (1, 0, 0), (0, 1, 0), id="roll brings the right to the top"),
        pytest.param(
            View(pitch_deg=90, roll_deg=90), (0, 0, -1), (-1, 0, 0), id="roll last: the far end comes up, then left"
        ),
    ],
)
def test_angles_turn_the_object(view: View, moves: tuple[int, ...], to: tuple[int, ...]) -> None:
    np.testing.assert_allclose(view.camera((9, 9)).view_from_object @ np.array(moves), to, atol=1e-12)


@given(yaw_deg=angles_deg, pitch_deg=angles_deg, roll_deg=angles_deg)
def test_a_turn_is_a_rotation(yaw_deg: float, pitch_deg: float, roll_deg: float) -> None:
    turn = View(yaw_deg=yaw_deg, pitch_deg=pitch_deg, roll_deg=roll_deg).camera((9, 9)).view_from_object
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1)


def test_the_near_is_in_front_of_the_far() -> None:
    for projection in Projection:
        depths = project(View(projection), np.array([[0, 0, 0.5], [0, 0, -0.5]]), (9, 9))[:, 2]
        assert depths[0] < depths[1]


@given(fov_deg=st.floats(1, 120))
def test_the_field_of_view_is_what_was_asked(fov_deg: float) -> None:
    view = View(fov_deg=fov_deg)
    distance = view.camera((9, 9)).eye_distance
    assert distance is not None
    edge = distance * math.tan(math.radians(fov_deg) / 2)
    camera = view.camera((9, 9))
    placed = camera.clip_from_view @ np.array([edge, 0, 0, 1])
    assert placed[0] / placed[3] == pytest.approx(1)


@given(zoom=st.floats(0.01, 100))
def test_zoom_magnifies(zoom: float) -> None:
    for projection in Projection:
        plain, zoomed = (project(View(projection, zoom=z), np.array([[0.1, 0.1, 0]]), (9, 9)) for z in (1, zoom))
        np.testing.assert_allclose(zoomed[0, :2], plain[0, :2] * zoom)


@pytest.mark.parametrize(
    ("wishes", "reason"),
    [
        ({"yaw_deg": math.nan}, "yaw nan"),
        ({"pitch_deg": math.inf}, "pitch inf"),
        ({"roll_deg": math.nan}, "roll nan"),
        ({"fov_deg": 0}, "field of view of 0 deg"),
        ({"fov_deg": 180}, "field of view of 180 deg"),
        ({"fov_deg": math.nan}, "field of view of nan deg"),
        ({"zoom": 0}, "zoom of 0"),
    ],
    ids=str,
)
def test_impossible_views_are_refused(wishes: dict[str, float], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        View(**wishes)  # type: ignore[arg-type] # by table
