"""Rays towards a distant light, against what geometry says."""

import dataclasses
import math

import numpy as np
import pytest

from processing.mesh.builtin import sphere
from processing.reference.camera import Camera
from processing.reference.shadow import hidden_points, reaches
from processing.reference.surface import visible_surface

FLAT = Camera(np.eye(3), np.diag([1.0, 1.0, -0.5, 1.0]), None)
TRIANGLE = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 2]])
ONE = np.array([[0, 1, 2]], np.int32)


@pytest.mark.parametrize(
    ("point", "hidden"),
    [
        pytest.param((0.2, 0.2, 0.0), True, id="below"),
        pytest.param((0.2, 0.2, 1.19), True, id="just below, where the triangle is higher"),
        pytest.param((0.2, 0.2, 1.2), False, id="on it"),
        pytest.param((0.2, 0.2, 1.21), False, id="above"),
        pytest.param((0.6, 0.6, 0.0), False, id="beside it, within its box"),
        pytest.param((-0.1, 0.2, 0.0), False, id="beside its box"),
    ],
)
def test_a_triangle_hides_what_is_below(point: tuple[float, float, float], hidden: bool) -> None:
    points = np.array([point, (5.0, 5.0, 0.0), (-5.0, 0.0, 0.0)])
    np.testing.assert_array_equal(hidden_points(points, TRIANGLE, ONE), [hidden, False, False])


def test_a_triangle_seen_from_its_edge_hides_nothing() -> None:
    upright = np.array([[0.0, 0, 1], [1, 0, 1], [0.5, 0, 2]])
    assert not hidden_points(np.array([[0.5, 0.0, 0.0]]), upright, ONE).any()


def test_a_ball_is_lit_on_the_lights_side() -> None:
    towards = np.array([0.6, 0.0, 0.8])
    surface = visible_surface(sphere(), FLAT, (64, 64))
    facing = surface.normals @ towards
    sure = np.abs(facing) > 0.08  # its facets are flat
    np.testing.assert_array_equal(reaches(surface, sphere(), FLAT, towards)[sure], facing[sure] > 0)


def test_a_disc_over_a_ball_throws_its_shadow_down() -> None:
    """A triangle in front of the camera, small, with the light behind the camera's shoulder."""
    ball = sphere()
    corners = np.array([[-0.1, -0.1, 1.5], [0.2, -0.1, 1.5], [-0.1, 0.2, 1.5]], np.float32)
    count = len(ball.positions)
    both = dataclasses.replace(
        ball,
        positions=np.concatenate([ball.positions, corners]),
        normals=np.concatenate([ball.normals, np.tile([[0, 0, 1]], (3, 1)).astype(np.float32)]),
        tangents=np.concatenate([ball.tangents, np.tile([[1, 0, 0]], (3, 1)).astype(np.float32)]),
        triangles=np.concatenate([ball.triangles, np.array([[count, count + 1, count + 2]], np.int32)]),
    )
    towards = np.array([math.sin(0.5), 0.0, math.cos(0.5)])
    surface = visible_surface(ball, FLAT, (128, 128))
    shadow = surface.points[~reaches(surface, both, FLAT, towards) & (surface.normals @ towards > 0.1)]
    ends = shadow + towards * ((1.5 - shadow[:, 2:]) / towards[2])
    assert len(shadow) > 30
    assert ends[:, :2].min() > -0.11
    assert (ends[:, 0] + ends[:, 1]).max() < 0.12
    assert np.ptp(ends[:, 0]) > 0.25 and np.ptp(ends[:, 1]) > 0.25, "the whole triangle"
