"""The reference picture of an AMC: where each texel stands, and what a sphere must look like."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal
from processing.amc.mips import mip_chain
from processing.amc.model import Amc
from processing.mesh.builtin import sphere
from processing.reference.amc import lookup, render_amc, table_coordinates
from processing.reference.camera import Camera
from processing.reference.surface import visible_normals

SIZE, DEPTH = 6, 4
CENTRE = np.array([[1 / SIZE, 1 / SIZE, 0.97]])
STRAIGHT = np.array([[0.0, 0.0, 1.0]])
LEFT_TO_RIGHT = Camera(np.eye(3), np.diag([1.0, 1.0, -0.5, 1.0]), None)


def random_amc(invariance: int = 1, size: int = SIZE, depth: int = DEPTH) -> Amc:
    random = np.random.default_rng(5)
    return Amc(random.random((depth, size, size, 3), np.float32), np.ones((depth, size, size), bool), invariance)


def read(amc: Amc, normal: tuple[float, float], k: float, level: int = 0) -> NDArray[np.float64]:
    colour: NDArray[np.float64] = lookup(amc, np.array([[*normal, 0.5]]), np.array([k]), level)[0]
    return colour


@pytest.mark.parametrize("invariance", [1, 2, 3])
def test_slice_j_stands_at_j_exactly(invariance: int) -> None:
    amc = random_amc(invariance)
    for j in range(DEPTH):
        found = read(amc, (1 / SIZE, -1 / SIZE), j / (invariance * DEPTH))
        np.testing.assert_allclose(found, amc.slices[j, SIZE // 2, SIZE // 2], rtol=1e-12)


def test_row_0_is_on_top_and_column_0_on_the_left() -> None:
    amc = random_amc()
    top, left = (SIZE - 1) / SIZE, -(SIZE - 1) / SIZE
    np.testing.assert_allclose(read(amc, (left, top), 0), amc.slices[0, 0, 0], rtol=1e-12)
    np.testing.assert_allclose(read(amc, (-left, top), 0), amc.slices[0, 0, -1], rtol=1e-12)
    np.testing.assert_allclose(read(amc, (left, -top), 0), amc.slices[0, -1, 0], rtol=1e-12)


def test_past_the_outer_texels_the_table_goes_on_as_it_ends() -> None:
    amc = random_amc()
    np.testing.assert_allclose(read(amc, (-1, 1), 0), amc.slices[0, 0, 0], rtol=1e-12)


def test_between_the_last_slice_and_the_first_is_their_mean() -> None:
    amc = random_amc()
    middle = (amc.slices[-1, 3, 3] + amc.slices[0, 3, 3]) / 2
    np.testing.assert_allclose(read(amc, (1 / SIZE, -1 / SIZE), 1 - 0.5 / DEPTH), middle, rtol=1e-6)


def test_a_smaller_level_stands_in_the_middle_of_what_it_averages() -> None:
    amc = random_amc()
    smaller = mip_chain(amc)[1].colours
    for j in range(DEPTH // 2):
        found = read(amc, (0.0, 0.0), (2 * j + 0.5) / DEPTH, level=1)
        np.testing.assert_allclose(found, smaller[j, 1, 1], rtol=1e-6)


@given(k=st.floats(0, 1, exclude_max=True), turns=st.integers(1, 3))
def test_a_lookup_repeats_r_times_a_turn(k: float, turns: int) -> None:
    amc = random_amc(3)
    np.testing.assert_allclose(read(amc, (0.1, 0.2), k), read(amc, (0.1, 0.2), k + turns / 3), atol=1e-9)


@given(angle_deg=st.floats(-720, 720))
def test_k_is_the_tangents_angle_as_a_share_of_a_turn(angle_deg: float) -> None:
    angle_rad = math.radians(angle_deg)
    tangent = np.array([[math.cos(angle_rad), math.sin(angle_rad), 0.0]])
    _, k = table_coordinates(STRAIGHT, tangent, STRAIGHT, TableNormal.RECTIFIED)
    assert 0 <= k[0] < 1
    assert math.remainder(k[0] - angle_deg / 360, 1) == pytest.approx(0, abs=1e-9)


def test_just_below_zero_comes_out_inside_the_turn() -> None:
    _, k = table_coordinates(STRAIGHT, np.array([[1.0, -1e-17, 0.0]]), STRAIGHT, TableNormal.RECTIFIED)
    assert 0 <= k[0] < 1


@pytest.mark.parametrize("kind", TableNormal)
def test_seen_along_z_no_normal_is_turned(kind: TableNormal) -> None:
    normals = np.array([[0.6, 0.0, 0.8], [0.0, -0.28, 0.96]])
    tangents = np.array([[0.8, 0.0, -0.6], [1.0, 0.0, 0.0]])
    turned, _ = table_coordinates(normals, tangents, np.repeat(STRAIGHT, 2, axis=0), kind)
    np.testing.assert_allclose(turned, normals, atol=1e-12)


def test_the_rectified_normal_is_half_way_from_mirrored_ray_to_z() -> None:
    to_eye = np.array([[math.sin(0.3), 0.0, math.cos(0.3)]])
    turned, _ = table_coordinates(to_eye, np.array([[0.0, 1.0, 0.0]]), to_eye, TableNormal.RECTIFIED)
    np.testing.assert_allclose(turned, [[math.sin(0.15), 0, math.cos(0.15)]], atol=1e-12)


def test_a_normal_that_looks_away_from_the_camera_is_read_at_the_rim() -> None:
    normal = np.array([[0.96, 0.0, -0.28]])
    to_eye = np.array([[-0.6, 0.0, 0.8]])
    turned, _ = table_coordinates(normal, np.array([[0.0, 1.0, 0.0]]), to_eye, TableNormal.CAMERA)
    np.testing.assert_allclose(turned, [[1, 0, 0]], atol=1e-12)


@pytest.mark.parametrize(
    ("normal", "front", "seen"),
    [
        pytest.param((0.6, 0.0, 0.8), True, (0.6, 0.0, 0.8), id="front stays"),
        pytest.param((0.6, 0.0, -0.8), False, (-0.6, 0.0, 0.8), id="back is turned round"),
        pytest.param((0.8, 0.0, 0.6), False, (0.8, 0.0, 0.6), id="only the triangle says back: the normal stays"),
        pytest.param((0.96, 0.0, -0.28), True, (1.0, 0.0, 0.001), id="only the normal says back: bent to the rim"),
    ],
)
def test_the_visible_side(normal: tuple[float, ...], front: bool, seen: tuple[float, ...]) -> None:
    found = visible_normals(np.array([normal]), STRAIGHT, np.array([front]))
    np.testing.assert_allclose(found, [seen], atol=1e-4)


def test_a_sphere_of_an_isotropic_material_looks_like_its_table() -> None:
    """Seen orthographically a pixel's normal is its own place in the disc, so that the picture is the table."""
    size = 48
    rows, columns = np.indices((size, size)) / size
    table = np.stack([rows, columns, rows * columns], axis=-1).astype(np.float32)[None]
    amc = Amc(table, np.ones((1, size, size), bool), "isotropic")
    picture = render_amc(amc, sphere(), LEFT_TO_RIGHT, (size, size))
    inner = np.hypot(*((np.indices((size, size)) + 0.5) / size * 2 - 1)) < 0.95
    assert picture[..., 3][inner].all()
    np.testing.assert_allclose(picture[..., :3][inner], table[0][inner], atol=2e-3)


def test_a_turned_object_reads_turned_tangents() -> None:
    """Turned a quarter about z, the sphere's parallels stand upright, and slice 1 of 4 is read instead of slice 0."""
    table = np.zeros((4, 2, 2, 3), np.float32)
    table[[0, 1, 2, 3]] += np.arange(4, dtype=np.float32)[:, None, None, None]
    amc = Amc(table, np.ones((4, 2, 2), bool), 1)
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    straight = render_amc(amc, sphere(), LEFT_TO_RIGHT, (9, 9))[4, 4, 0]
    turned = render_amc(amc, sphere(), Camera(quarter, LEFT_TO_RIGHT.clip_from_view, None), (9, 9))[4, 4, 0]
    assert (straight, turned) == (pytest.approx(0, abs=1e-6), pytest.approx(1, abs=1e-6))
