"""Turning by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from viewer.view import View
from viewer.window.turn import UNTURNED, Spot, Turn, about, angles_deg, arc, matrix, of_angles, spot_at, then

parts = st.floats(-1, 1)
turns = (
    st.tuples(parts, parts, parts, parts)
    .filter(lambda q: math.hypot(*q) > 0.1)
    .map(lambda q: (q[0] / math.hypot(*q), q[1] / math.hypot(*q), q[2] / math.hypot(*q), q[3] / math.hypot(*q)))
)
spots = st.tuples(st.floats(-3, 3), st.floats(-3, 3))
inner = st.tuples(st.floats(-0.45, 0.45), st.floats(-0.45, 0.45))


def on_sphere(spot: Spot) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([*spot, math.sqrt(1 - spot[0] ** 2 - spot[1] ** 2)])


@given(start=inner, end=inner, radius=st.floats(0.2, 5))
def test_what_is_under_the_hand_stays_under_it(start: Spot, end: Spot, radius: float) -> None:
    turn = arc((start[0] * radius, start[1] * radius), (end[0] * radius, end[1] * radius), radius)
    np.testing.assert_allclose(matrix(turn) @ on_sphere(start), on_sphere(end), atol=1e-9)


@given(start=spots, end=spots)
def test_every_drag_is_a_rotation_and_back_is_its_inverse(start: Spot, end: Spot) -> None:
    there, back = arc(start, end, 0.9), arc(end, start, 0.9)
    np.testing.assert_allclose(matrix(there) @ matrix(there).T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(matrix(then(there, back)), np.eye(3), atol=1e-12)


def test_beside_the_ball_the_object_turns_about_the_line_of_sight() -> None:
    turned = matrix(arc((30.0, 0.0), (0.0, 30.0), 1.0))
    np.testing.assert_allclose(turned, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=0.05)


@given(first=turns, second=turns)
def test_turns_follow_each_other_as_matrices_do(first: Turn, second: Turn) -> None:
    np.testing.assert_allclose(matrix(then(first, second)), matrix(second) @ matrix(first), atol=1e-12)


@given(turn=turns)
def test_every_turn_is_that_of_a_view(turn: Turn) -> None:
    yaw, pitch, roll = angles_deg(turn)
    view = View(yaw_deg=yaw, pitch_deg=pitch, roll_deg=roll)
    np.testing.assert_allclose(view.camera((9, 9)).view_from_object, matrix(turn), atol=1e-7)


@pytest.mark.parametrize("pitch_deg", [90, -90])
@given(yaw_deg=st.floats(-180, 180), roll_deg=st.floats(-180, 180))
def test_also_where_yaw_and_roll_are_the_same(pitch_deg: float, yaw_deg: float, roll_deg: float) -> None:
    turn = of_angles(yaw_deg, pitch_deg, roll_deg)
    yaw, pitch, roll = angles_deg(turn)
    view = View(yaw_deg=yaw, pitch_deg=pitch, roll_deg=roll)
    np.testing.assert_allclose(view.camera((9, 9)).view_from_object, matrix(turn), atol=1e-7)


@given(angles=st.tuples(*[st.floats(-400, 400)] * 3))
def test_angles_mean_what_they_mean_to_a_view(angles: tuple[float, float, float]) -> None:
    yaw, pitch, roll = angles
    view = View(yaw_deg=yaw, pitch_deg=pitch, roll_deg=roll)
    np.testing.assert_allclose(matrix(of_angles(*angles)), view.camera((9, 9)).view_from_object, atol=1e-12)


def test_a_turn_goes_counter_clockwise_about_its_axis() -> None:
    np.testing.assert_allclose(matrix(about((0, 0, 1), math.pi / 2)) @ [1, 0, 0], [0, 1, 0], atol=1e-12)
    np.testing.assert_array_equal(matrix(UNTURNED), np.eye(3))


def test_spots_are_counted_from_the_middle_up_and_right() -> None:
    assert spot_at((150, 50), (300, 100)) == (0, 0)
    assert spot_at((300, 0), (300, 100)) == (3, 1)
    assert spot_at((0, 100), (300, 100)) == (-3, -1)
