import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from processing.paraboloid.maps import places, texel_directions

SIZE = 16


def test_a_texel_is_found_where_its_direction_says() -> None:
    along = (np.arange(SIZE) + 0.5) / SIZE
    for front, directions in zip((True, False), texel_directions(SIZE), strict=True):
        np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1)
        in_front, columns, rows = places(directions)
        within = np.hypot(2 * along - 1, 2 * along[:, None] - 1) < 1
        np.testing.assert_array_equal(in_front[within], front)
        np.testing.assert_array_equal(in_front[~within], not front)
        np.testing.assert_allclose(columns[within], np.broadcast_to(along, (SIZE, SIZE))[within])
        np.testing.assert_allclose(rows[within], np.broadcast_to(along[:, None], (SIZE, SIZE))[within])


def test_the_middle_looks_along_the_axis_and_up_is_up() -> None:
    _, columns, rows = places(np.array([[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, -1]], np.float64))
    np.testing.assert_allclose(np.stack([columns, rows]), [[0.5, 0.5, 1, 0.5], [0.5, 0, 0.5, 0.5]])


@given(st.floats(-np.pi, np.pi), st.floats(0, np.pi))
def test_every_direction_lies_in_the_unit_circle_of_one_map(azimuth: float, polar: float) -> None:
    direction = np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])
    in_front, column, row = places(direction)
    u, v = 2 * column - 1, 1 - 2 * row
    q = u * u + v * v
    assert q <= 1 + 1e-12
    back_again = np.array([2 * u, 2 * v, (1 - q) if in_front else (q - 1)]) / (1 + q)
    np.testing.assert_allclose(back_again, direction, atol=1e-12)
