"""Vertices at seams: averaged where the grain goes on, split where it does not."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.builtin import pillow, ribbon, sphere, torus
from processing.mesh.corners import CornerMesh, put_together
from processing.mesh.model import Mesh
from processing.mesh.seams import split_at_seams
from processing.mesh.tangents import vertex_tangents

F64 = NDArray[np.float64]
SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float64)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


def quad(*, left: float = 0, turn_deg: float = 0, shift: float = 0) -> CornerMesh:
    """A square from x = left to left + 1 in the plane z = 0; its grain lies at `turn_deg` from x."""
    corners = SQUARE + np.array([left, 0])
    cosine, sine = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    uvs = corners @ np.array([[cosine, -sine], [sine, cosine]]) + shift
    return CornerMesh(np.concatenate([corners, np.zeros((4, 1))], axis=1), uvs, HALVES, HALVES)


def at_place(mesh: Mesh, place: tuple[float, float, float]) -> F64:
    """The different tangents at one place."""
    here = np.all(np.abs(mesh.positions - np.array(place)) < 1e-6, axis=1)
    return np.unique(mesh.tangents[here].astype(np.float64).round(5), axis=0)


def angles_deg(tangents: F64) -> list[float]:
    return sorted(round(math.degrees(math.atan2(y, x)) % 360, 2) for x, y, _ in tangents)


@pytest.mark.parametrize(
    ("right", "vertices", "grains_deg"),
    [
        pytest.param(quad(left=1), 6, [0], id="one piece of cloth"),
        pytest.param(quad(left=1, shift=5), 8, [0], id="two pieces, cut and sewn straight"),
        pytest.param(quad(left=1, turn_deg=30), 8, [0, 30], id="a piece at an angle"),
        pytest.param(quad(left=1, turn_deg=4), 8, [2], id="so little that it is an error of the mesh"),
        pytest.param(quad(left=1, turn_deg=6), 8, [0, 6], id="just more than that"),
        pytest.param(quad(left=1, turn_deg=180), 8, [0, 180], id="a piece upside down"),
    ],
)
def test_grain_is_averaged_only_where_it_goes_on(right: CornerMesh, vertices: int, grains_deg: list[float]) -> None:
    mesh = split_at_seams(put_together([quad(), right]))
    assert len(mesh.positions) == vertices
    for y in (0, 1):
        assert angles_deg(at_place(mesh, (1, y, 0))) == pytest.approx(grains_deg, abs=0.7)
    assert angles_deg(at_place(mesh, (0, 0, 0))) == [0], "away from the seam a piece keeps its own"


@pytest.mark.parametrize(("bend_deg", "vertices"), [(50, 6), (70, 8)])
def test_within_a_piece_a_bend_splits_only_past_its_limit(bend_deg: float, vertices: int) -> None:
    """The coordinates go on across the common edge; the grain, 45° before it, bends there."""
    left, right = quad(), quad(left=1)
    x, y = right.positions[:, 0] - 1, right.positions[:, 1]
    slope = 1 / math.tan(math.radians(45 + bend_deg))
    bent = np.stack([1 + y + slope * x, y + (slope - 1) * x], axis=1)
    sheared = np.stack([left.uvs.sum(axis=1), left.uvs[:, 1]], axis=1)
    mesh = split_at_seams(put_together([replace(left, uvs=sheared), replace(right, uvs=bent)]))
    assert len(mesh.positions) == vertices
    assert len(at_place(mesh, (1, 0, 0))) == vertices - 5 - (vertices == 8)


@pytest.mark.parametrize(
    ("mirror", "grains_deg"),
    [
        pytest.param([-1, 1], [0, 180], id="from left to right"),
        pytest.param([1, -1], [0], id="from top to bottom, where grain runs alike and across it does not"),
    ],
)
def test_a_mirrored_piece_is_never_averaged(mirror: list[int], grains_deg: list[float]) -> None:
    right = quad(left=1)
    mirrored = (right.uvs - np.array([1, 0])) * mirror + np.array([1, 0])
    mesh = split_at_seams(put_together([quad(), replace(right, uvs=mirrored)]))
    assert angles_deg(at_place(mesh, (1, 0, 0))) == grains_deg
    assert np.all(mesh.positions == [1, 0, 0], axis=1).sum() == 2


ROOF = np.array([[0, 0, 0], [1, 0, 0.2], [1, 1, 0.2], [0, 1, 0], [2, 0, 0], [2, 1, 0]], np.float64)


def roof(*, turn_deg: float) -> list[CornerMesh]:
    """Two squares that rise to a ridge at x = 1."""
    return [replace(quad(), positions=ROOF[:4]), replace(quad(turn_deg=turn_deg, left=1), positions=ROOF[[1, 4, 5, 2]])]


def test_the_surface_stays_smooth_where_the_grain_breaks() -> None:
    mesh = split_at_seams(put_together(roof(turn_deg=40)))
    ridge = np.all(np.abs(mesh.positions - ROOF[1]) < 1e-6, axis=1)
    normals, tangents = mesh.normals[ridge], mesh.tangents[ridge]
    assert len(normals) == 2
    np.testing.assert_array_equal(normals[0], normals[1])
    assert abs(normals[0, 0]) < normals[0, 2] * 0.2, "between the two slopes"
    assert math.degrees(math.acos(tangents[0] @ tangents[1])) == pytest.approx(40, abs=3)


def test_edges_that_the_file_wants_hard_stay_hard() -> None:
    """The grain goes on over the ridge; the given normals do not, and are not touched."""
    slopes = np.array([[-0.2, 0, 1], [0.2, 0, 1]]) / math.hypot(0.2, 1)
    pieces = [
        replace(piece, normals=np.tile(slope, (4, 1))) for piece, slope in zip(roof(turn_deg=0), slopes, strict=True)
    ]
    mesh = split_at_seams(put_together(pieces), crease_deg=60)
    ridge = np.all(np.abs(mesh.positions - ROOF[1]) < 1e-6, axis=1)
    np.testing.assert_allclose(mesh.normals[ridge], slopes, atol=1e-6)
    np.testing.assert_allclose(np.sum(mesh.normals * mesh.tangents, axis=1), 0, atol=1e-6)


def test_equal_rows_are_one_vertex() -> None:
    """Some programs write every triangle's corners anew."""
    flat = quad()
    positions, uvs = flat.positions[HALVES].reshape(-1, 3), flat.uvs[HALVES].reshape(-1, 2)
    positions[3] = -positions[3]  # −0 and 0 are one place
    corners = np.arange(6).reshape(2, 3)
    assert len(split_at_seams(CornerMesh(positions, uvs, corners, corners)).positions) == 4


@pytest.mark.parametrize(
    "mesh",
    [
        pytest.param(ribbon(60, 8), id="ribbon"),
        pytest.param(torus(48, 24), id="torus"),
        pytest.param(pillow(24), id="pillow"),
    ],
)
def test_without_seams_it_is_the_plain_average(mesh: Mesh) -> None:
    """As long as the vertices that the mesh has are kept apart by their places or coordinates."""
    found = split_at_seams(_raw(mesh), seam_deg=0)
    plain = vertex_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles)
    # Corner by corner, for the order of the vertices is another.
    np.testing.assert_allclose(found.tangents[found.triangles], plain[mesh.triangles], atol=2e-3)


def test_where_a_surface_closes_the_grain_is_averaged_over_the_coordinates_jump() -> None:
    """On a coarse torus the one-sided gradients lie degrees off along the line where u jumps back to 0."""
    mesh = torus(24, 12)
    found = split_at_seams(_raw(mesh), seam_deg=20)
    at_jump = found.uvs[:, 0] == 0
    plain = vertex_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles)
    along = np.array([1, 0, 0])
    assert np.min(found.tangents[at_jump] @ along) > np.min(plain[mesh.uvs[:, 0] == 0] @ along)
    np.testing.assert_allclose(found.tangents[at_jump] @ along, 1, atol=1e-3)


def test_round_a_pole_each_triangle_keeps_its_own_grain() -> None:
    mesh = split_at_seams(_raw(sphere(24, 12)))
    pole = np.abs(mesh.positions[:, 1] - 1) < 1e-6
    assert pole.sum() == 24
    angles = np.unwrap(np.sort(np.arctan2(mesh.tangents[pole, 0], mesh.tangents[pole, 2])))
    np.testing.assert_allclose(np.diff(angles), math.tau / 24, atol=1e-3)


@given(turns_deg=st.lists(st.floats(-180, 180), min_size=2, max_size=4), seed=st.integers(0, 99))
def test_every_corner_keeps_its_place_and_its_coordinates(turns_deg: list[float], seed: int) -> None:
    strip = put_together([quad(left=left, turn_deg=turn, shift=left) for left, turn in enumerate(turns_deg)])
    shuffled = np.random.default_rng(seed).permutation(len(strip.position_corners))
    raw = replace(strip, position_corners=strip.position_corners[shuffled], uv_corners=strip.uv_corners[shuffled])
    mesh = split_at_seams(raw)
    np.testing.assert_allclose(mesh.positions[mesh.triangles], raw.positions[raw.position_corners], atol=1e-6)
    np.testing.assert_allclose(mesh.uvs[mesh.triangles], raw.uvs[raw.uv_corners], atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.sum(mesh.tangents * mesh.normals, axis=1), 0, atol=1e-6)
    for left, turn_deg in enumerate(turns_deg):
        inside = mesh.tangents[mesh.triangles][_of_quad(raw, left)]
        off_deg = np.degrees(np.arctan2(inside[..., 1], inside[..., 0])) - turn_deg
        assert np.all(np.abs((off_deg + 180) % 360 - 180) < 5.01), "no grain moves by more than two pieces' agreement"


def _of_quad(raw: CornerMesh, left: int) -> NDArray[np.bool_]:
    middles = raw.positions[raw.position_corners, 0].mean(axis=1)
    return np.asarray(np.floor(middles) == left)


@pytest.mark.parametrize("missing", [True, False], ids=["one has none", "both have some"])
def test_normals_are_kept_if_all_pieces_have_some(missing: bool) -> None:
    leaning = np.tile(np.array([0.6, 0, 0.8]), (4, 1))
    pieces = [replace(quad(), normals=leaning), replace(quad(left=1), normals=None if missing else leaning)]
    mesh = split_at_seams(put_together(pieces))
    np.testing.assert_allclose(mesh.normals, np.tile([0, 0, 1] if missing else [0.6, 0, 0.8], (6, 1)), atol=1e-6)


@pytest.mark.parametrize(
    ("raw", "reason"),
    [
        pytest.param(replace(quad(), position_corners=HALVES + 1), "positions that are not among its 4", id="place"),
        pytest.param(replace(quad(), uv_corners=HALVES - 1), "texture coordinates that are not", id="coordinates"),
        pytest.param(replace(quad(), positions=quad().positions * np.nan), "no number", id="no number"),
        pytest.param(replace(quad(), position_corners=HALVES * 0), "no triangle with an area", id="points"),
        pytest.param(
            replace(quad(), position_corners=np.array([[0, 1, 2], [0, 2, 1]])), "have no length", id="folded shut"
        ),
        pytest.param(replace(quad(), uvs=quad().uvs * [0, 1]), "u does not vary around 4 of 4", id="u stands still"),
    ],
)
def test_what_makes_no_mesh_is_refused(raw: CornerMesh, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        split_at_seams(raw)


def _raw(mesh: Mesh) -> CornerMesh:
    return CornerMesh(mesh.positions, mesh.uvs, mesh.triangles, mesh.triangles, mesh.normals)
