"""Tangents turned and painted: directions on the surface that can be told by hand."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.builtin import BUILTIN_NAMES, builtin_mesh, torus
from processing.mesh.fields import painted, turned
from processing.mesh.model import Mesh

F32 = NDArray[np.float32]
RING = torus(12, 8)


def angle_deg(mesh: Mesh, field: Mesh) -> NDArray[np.float64]:
    """From one mesh's tangents to the other's, counter-clockwise seen from outside."""
    across = np.cross(mesh.normals.astype(np.float64), mesh.tangents)
    parts = [np.sum(field.tangents * axis, axis=1) for axis in (across, mesh.tangents)]
    angles: NDArray[np.float64] = np.degrees(np.arctan2(*parts))
    return angles


def square(*, mirrored: bool = False) -> Mesh:
    """A unit square in the plane z = 0, with its texture upright or mirrored from top to bottom."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    return Mesh(
        positions=np.concatenate([corners, np.zeros((4, 1), np.float32)], axis=1),
        normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
        tangents=np.tile(np.array([1, 0, 0], np.float32), (4, 1)),
        uvs=(corners * [1, -1]).astype(np.float32) if mirrored else corners,
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )


def plain(x: float, y: float) -> F32:
    return np.full((2, 3, 2), (x, y), np.float32)


def test_a_quarter_turn_on_the_front_of_a_torus_points_up() -> None:
    front = np.all(np.abs(RING.positions - [0, 0, 1]) < 1e-6, axis=1)
    np.testing.assert_allclose(RING.tangents[front], np.tile([1, 0, 0], (front.sum(), 1)), atol=1e-6)
    np.testing.assert_allclose(turned(RING, 90).tangents[front], np.tile([0, 1, 0], (front.sum(), 1)), atol=1e-6)


@pytest.mark.parametrize("name", BUILTIN_NAMES)
def test_a_turn_stays_in_the_surface_and_changes_nothing_else(name: str) -> None:
    mesh = builtin_mesh(name)
    field = turned(mesh, 35)
    np.testing.assert_allclose(angle_deg(mesh, field), 35, atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(field.tangents, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.sum(field.tangents * field.normals, axis=1), 0, atol=1e-6)
    for part in ("positions", "normals", "uvs", "triangles"):
        assert getattr(field, part) is getattr(mesh, part)


@given(first=st.floats(-720, 720), second=st.floats(-720, 720))
def test_turns_add_up(first: float, second: float) -> None:
    twice, once = turned(turned(RING, first), second), turned(RING, first + second)
    np.testing.assert_allclose(twice.tangents, once.tangents, atol=1e-6)


@pytest.mark.parametrize("whole", [0, 360, -3600])
def test_whole_turns_change_nothing(whole: float) -> None:
    np.testing.assert_allclose(turned(RING, whole).tangents, RING.tangents, atol=1e-7)


@pytest.mark.parametrize("angle", [math.nan, math.inf])
def test_a_turn_by_no_number_is_refused(angle: float) -> None:
    with pytest.raises(InputError, match="give a number of degrees"):
        turned(RING, angle)


@given(angle=st.floats(-179, 179), length=st.floats(0.1, 1))
def test_one_colour_turns_the_grain_everywhere(angle: float, length: float) -> None:
    turn = math.radians(angle)
    field = painted(RING, plain(length * math.cos(turn), length * math.sin(turn)))
    np.testing.assert_allclose(field.tangents, turned(RING, angle).tangents, atol=1e-5)


def test_on_a_mirrored_piece_up_in_the_picture_is_up_in_the_picture() -> None:
    """Where v grows downwards on the surface, so does what is painted upwards."""
    np.testing.assert_allclose(painted(square(), plain(0, 1)).tangents[:, 1], 1)
    np.testing.assert_allclose(painted(square(mirrored=True), plain(0, 1)).tangents[:, 1], -1)
    np.testing.assert_allclose(painted(square(mirrored=True), plain(1, 0)).tangents[:, 0], 1)


def at(u: float, v: float) -> Mesh:
    """The square, all of it at one place of the picture."""
    return dataclasses.replace(square(), uvs=np.full((4, 2), (u, v), np.float32))


def compass(*degrees: float, rows: int = 1) -> F32:
    turns = np.radians(np.array(degrees)).reshape(rows, -1)
    return np.stack([np.cos(turns), np.sin(turns)], axis=-1).astype(np.float32)


@pytest.mark.parametrize(
    ("picture", "u", "v", "expected_deg"),
    [
        pytest.param(compass(350, 10), 0.5, 0.5, 0, id="between 350 and 10 is 0, not 180"),
        pytest.param(compass(20, 40, 60, 80), 0.375, 0.5, 40, id="a texel's own value in its middle"),
        pytest.param(compass(20, 40), 0.5, 0.5, 30, id="half way between two"),
        pytest.param(compass(20, 40), 0.0, 0.5, 30, id="the edge lies between the last and the first"),
        pytest.param(compass(20, 40, 60, 80), 7.375, -3.5, 40, id="and so on beyond 1"),
        pytest.param(compass(20, 80, rows=2), 0.5, 0.75, 20, id="the first row is the upper one"),
        pytest.param(compass(20, 80, rows=2), 0.5, 0.25, 80, id="the last row is the lower one"),
    ],
)
def test_a_place_is_read_between_its_texels(picture: F32, u: float, v: float, expected_deg: float) -> None:
    mesh = at(u, v)
    np.testing.assert_allclose(angle_deg(mesh, painted(mesh, picture)), expected_deg, atol=1e-3)


@pytest.mark.parametrize(
    ("picture", "reason"),
    [
        pytest.param(plain(0, 0), "map.png: names no direction at 4 of 4 vertices", id="grey"),
        pytest.param(plain(1 / 255, 1 / 255), "at 4 of 4", id="grey, as eight bits have it"),
        pytest.param(compass(0, 180), "at 4 of 4", id="between opposite directions"),
        pytest.param(plain(math.nan, 1), "at 4 of 4", id="no number"),
        pytest.param(np.zeros((2, 2, 3), np.float32), "holds no directions", id="three channels"),
        pytest.param(np.zeros((0, 2, 2), np.float32), "holds no directions", id="nothing"),
    ],
)
def test_where_nothing_is_painted_is_refused(picture: F32, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        painted(at(0.5, 0.5), picture, "map.png")


def test_only_the_vertices_without_direction_are_counted() -> None:
    picture = compass(0, 0, 0, 0, rows=2)
    picture[0, 1] = 0
    mesh = dataclasses.replace(
        square(), uvs=np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]], np.float32)
    )
    with pytest.raises(InputError, match="at 1 of 4 vertices; paint where it is grey"):
        painted(mesh, picture)
