"""The rasteriser: every pixel once, the nearest first, attributes straight in space."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.reference.raster import rasterise

FLAT = np.diag([1.0, 1.0, -1.0, 1.0])
SIZE = (8, 4)  # powers of two, so that places on pixels are exact


def on_pixels(columns_and_rows: list[tuple[float, float]], z: float = 0.0) -> NDArray[np.float64]:
    """View-frame points that the flat projection brings to places in a picture of SIZE, top left at (0, 0)."""
    return np.array([[2 * x / SIZE[0] - 1, 1 - 2 * y / SIZE[1], z] for x, y in columns_and_rows])


def coverage(points: NDArray[np.float64], triangles: list[list[int]]) -> NDArray[np.int64]:
    """How often the pixels are covered, each triangle drawn for itself."""
    counts = np.zeros((SIZE[1], SIZE[0]), np.int64)
    for triangle in triangles:
        seen = rasterise(points, np.array([triangle]), FLAT, SIZE)
        counts[seen.rows, seen.columns] += 1
    return counts


@given(
    x=st.integers(0, 16).map(lambda half: half / 2),
    y=st.integers(0, 8).map(lambda half: half / 2),
)
def test_triangles_round_a_point_cover_every_pixel_once(x: float, y: float) -> None:
    """The edges run through pixel centres time and again, and each centre still has one owner."""
    points = on_pixels([(0, 0), (8, 0), (8, 4), (0, 4), (x, y)])
    counts = coverage(points, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    np.testing.assert_array_equal(counts, 1)


@given(st.permutations([0, 1, 2, 3]))
def test_it_does_not_matter_where_a_triangle_starts_or_how_it_winds(order: list[int]) -> None:
    points = on_pixels([(0.5, 0.5), (7.5, 0.5), (7.5, 3.5), (0.5, 3.5)])
    corners = [corner for corner in order if corner != 3]
    np.testing.assert_array_equal(coverage(points, [corners]), coverage(points, [[0, 1, 2]]))


def test_edges_on_centres_belong_to_the_right_and_the_lower_triangle() -> None:
    square = on_pixels([(1.5, 1.5), (4.5, 1.5), (4.5, 3.5), (1.5, 3.5)])
    counts = coverage(square, [[0, 1, 2], [0, 2, 3]])
    rows, columns = np.nonzero(counts)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (1, 2, 1, 3)
    assert counts.sum() == 2 * 3


@pytest.mark.parametrize("order", [[0, 1], [1, 0]], ids=["near one first", "far one first"])
def test_the_nearest_is_seen(order: list[int]) -> None:
    points = np.concatenate([on_pixels([(0, 0), (16, 0), (0, 8)], z=0.5), on_pixels([(0, 0), (16, 0), (0, 8)], z=-0.5)])
    triangles = np.array([[0, 1, 2], [3, 4, 5]])[order]
    seen = rasterise(points, triangles, FLAT, SIZE)
    assert len(seen.rows) == SIZE[0] * SIZE[1]
    np.testing.assert_array_equal(seen.triangles, order.index(0))


def test_sides_are_told_apart() -> None:
    points = on_pixels([(0, 4), (8, 4), (0, 0)])
    assert rasterise(points, np.array([[0, 1, 2]]), FLAT, SIZE).front.all(), "counter-clockwise as seen"
    assert not rasterise(points, np.array([[0, 2, 1]]), FLAT, SIZE).front.any()


def test_attributes_are_straight_in_space_not_on_the_screen() -> None:
    """A floor that runs away from the eye: the depth read at each pixel is that of the pixel's own ray."""
    eye_from_view = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    points = np.array([[-50.0, -1, -2], [50, -1, -2], [50, -1, -40], [-50, -1, -40]])
    seen = rasterise(points, np.array([[0, 1, 2], [0, 2, 3]]), eye_from_view, (32, 32))
    found = seen.interpolate(points, np.array([[0, 1, 2], [0, 2, 3]]))
    ray_y = 1 - 2 * (seen.rows + 0.5) / 32
    assert len(found) > 200
    np.testing.assert_allclose(found[:, 2], 1 / ray_y, rtol=1e-9)
    np.testing.assert_allclose(seen.weights.sum(axis=1), 1)


def test_what_lies_outside_the_picture_is_not_drawn() -> None:
    seen = rasterise(on_pixels([(20, 20), (30, 20), (20, 30)]), np.array([[0, 1, 2]]), FLAT, SIZE)
    assert len(seen.rows) == 0


def test_a_triangle_without_area_covers_nothing() -> None:
    seen = rasterise(on_pixels([(0.5, 0.5), (4.5, 0.5), (2.5, 0.5)]), np.array([[0, 1, 2]]), FLAT, SIZE)
    assert len(seen.rows) == 0


def test_a_mesh_round_the_eye_is_refused() -> None:
    behind = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]])
    with pytest.raises(InputError, match="reaches behind the eye"):
        rasterise(np.array([[0.0, 0, -1], [1, 0, -1], [0, 1, 1]]), np.array([[0, 1, 2]]), behind, SIZE)
