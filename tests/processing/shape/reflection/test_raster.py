"""Beside the same sums in plain NumPy on the sphere itself, polygon by polygon."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.paraboloid.maps import texel_directions
from processing.shape.reflection.raster import SUMS, chart, draw

F64 = NDArray[np.float64]
SIZE = 24


def drawn(corners: list[list[int]], mirrored: F64, colours: F64, *, quads: bool) -> F64:
    sums = np.zeros((2, SIZE, SIZE, SUMS))
    for half in range(2):
        places = chart(mirrored, front=half == 0)
        draw(np.array(corners, np.int32), places, colours.astype(np.float32), 2, quads, sums[half])
    return sums


def unit(vectors: F64) -> F64:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def mean_value(place: F64, corners: F64) -> F64:
    """Equation 8 of Langer, Belyaev and Seidel by its angles."""
    count = len(corners)
    arcs = np.arccos(corners @ place)
    away = unit(corners - (corners @ place)[:, None] * place)
    following = np.roll(away, -1, axis=0)
    angles = np.arctan2(np.cross(away, following) @ place, np.sum(away * following, axis=1))
    halves = np.tan(angles / 2)
    weights = np.array([(halves[k - 1] + halves[k]) / np.sin(arcs[k]) for k in range(count)])
    return np.asarray(weights / weights.sum())


def rectified(r: F64) -> F64:
    return unit(r + np.array([0, 0, 1.0]))


QUAD = unit(np.array([[-0.5, 0.55, 0.9], [0.45, 0.5, 0.8], [0.6, -0.35, 0.7], [-0.4, -0.45, 1.0]]))
COLOURS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], np.float64)


def test_quads_have_spherical_mean_value_coordinates_on_rectified_normals() -> None:
    sums = drawn([[0, 1, 2, 3]], QUAD, COLOURS, quads=True)[0]
    inside = np.argwhere(sums[..., -1] > 0)
    assert len(inside) > 20
    directions = texel_directions(SIZE)[0]
    for row, column in inside:
        shares = mean_value(rectified(directions[row, column]), rectified(QUAD))
        np.testing.assert_allclose(sums[row, column, :3] / sums[row, column, -1], shares @ COLOURS, atol=1e-6)


def test_two_triangles_have_spherical_coordinates_each() -> None:
    sums = drawn([[0, 1, 2, 3]], QUAD, COLOURS, quads=False)[0]
    directions = texel_directions(SIZE)[0]
    n = rectified(QUAD)
    seen = 0
    for row, column in np.argwhere(sums[..., -1] > 0):
        for corners in ((0, 1, 2), (0, 2, 3)):
            shares = np.linalg.solve(n[list(corners)].T, rectified(directions[row, column]))
            if np.all(shares >= 0):
                found = sums[row, column, :3] / sums[row, column, -1]
                np.testing.assert_allclose(found, shares / shares.sum() @ COLOURS[list(corners)], atol=1e-6)
                seen += 1
    assert seen > 20


@pytest.mark.parametrize("quads", [False, True])
def test_both_ways_draw_the_same_texels_and_weigh_them_by_the_longest_arc(quads: bool) -> None:
    sums = drawn([[0, 1, 2, 3]], QUAD, COLOURS, quads=quads)[0]
    weights = sums[..., -1]
    n = rectified(QUAD)
    expected = (1 - np.arccos((n @ n.T).min()) / np.pi) ** 200
    np.testing.assert_allclose(weights[weights > 0], expected, rtol=1e-9)
    other = drawn([[0, 1, 2, 3]], QUAD, COLOURS, quads=not quads)[0][..., -1]
    np.testing.assert_array_equal(weights > 0, other > 0)


def test_the_smaller_of_two_polygons_wins() -> None:
    """Equation 2: nearly alone if it is clearly smaller, half and half if they are alike."""
    small = unit(QUAD + np.array([0, 0, 0.6]))
    for other, share in ((small, 1.0), (QUAD, 0.5)):
        mirrored = np.concatenate([QUAD, other])
        colours = np.array([[1.0, 0, 0]] * 4 + [[0, 1.0, 0]] * 4)
        sums = drawn([[0, 1, 2, 3], [4, 5, 6, 7]], mirrored, colours, quads=False)[0]
        middle = sums[SIZE // 2, SIZE // 2]
        np.testing.assert_allclose(middle[1] / middle[-1], share, atol=1e-3)


def test_around_the_opposite_pole_nothing_is_torn() -> None:
    """Rectified normals have no value at r = −z, which is the middle of the back half."""
    along = np.linspace(-0.5, 0.5, 9)
    x, y = np.meshgrid(along, along)
    mirrored = unit(np.stack([x, y, -np.ones_like(x)], axis=-1)).reshape(-1, 3)
    assert [0, 0, -1] in mirrored.tolist()
    index = np.arange(81).reshape(9, 9)
    corners = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    sums = drawn(corners.tolist(), mirrored, mirrored, quads=True)
    assert not sums[0].any()
    directions = texel_directions(SIZE)[1]
    inside = (np.abs(directions[..., :2]).max(axis=-1) < 0.44 * -directions[..., 2]) & (directions[..., 2] < 0)
    assert inside.sum() > 10
    assert (sums[1][inside][:, -1] > 0).all()
    np.testing.assert_allclose(sums[1][inside][:, :3] / sums[1][inside][:, -1:], directions[inside], atol=0.01)


def test_a_triangle_is_drawn_and_what_is_too_large_is_not() -> None:
    sums = drawn([[0, 1, 2, -1]], QUAD, COLOURS, quads=True)[0]
    assert (sums[..., -1] > 0).any()
    large = unit(np.array([[1, 0, 0.2], [-1, 0.3, 0.2], [0, -1, 0.2], [0.1, 1, 0.1]]))
    assert not drawn([[0, 1, 2, 3]], large, COLOURS, quads=False).any()


def test_texels_know_the_pixels_they_are_from() -> None:
    sums = drawn([[0, 1, 3, 2]], QUAD[[0, 1, 3, 2]], COLOURS, quads=False)[0]
    seen = sums[sums[..., -1] > 0]
    at = seen[:, 3:5] / seen[:, -1:]
    assert at.min() >= 0
    assert at.max() <= 1
    assert np.ptp(at[:, 0]) > 0.5
    assert np.ptp(at[:, 1]) > 0.5
