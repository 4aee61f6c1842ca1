"""From pieces of a file to a mesh: what is missing is derived and said, what makes no mesh is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh import assemble as module
from processing.mesh.assemble import assemble
from processing.mesh.builtin import BUILTIN_NAMES, builtin_mesh, sphere, torus
from processing.mesh.corners import CornerMesh
from processing.mesh.files.pieces import Piece
from processing.mesh.model import Mesh
from processing.mesh.seams import split_at_seams
from processing.mesh.sewn import skirt
from tests.processing.mesh.files.scenes import HALVES, NORMALS, SQUARE, UVS

F64 = NDArray[np.float64]
TRIANGLES = HALVES.astype(np.int64)
CUBE = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)])
CUBE_SIDES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)


def square(**changes: object) -> Piece:
    whole = Piece(
        SQUARE.astype(np.float64),
        TRIANGLES,
        UVS.astype(np.float64),
        TRIANGLES,
        NORMALS.astype(np.float64),
        TRIANGLES,
    )
    return replace(whole, **changes)  # type: ignore[arg-type]


def piece_of(mesh: Mesh) -> Piece:
    triangles = mesh.triangles.astype(np.int64)
    positions, uvs, normals = (a.astype(np.float64) for a in (mesh.positions, mesh.uvs, mesh.normals))
    return Piece(positions, triangles, uvs, triangles, normals, triangles)


def check_frames(mesh: Mesh) -> None:
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.sum(mesh.normals * mesh.tangents, axis=1), 0, atol=1e-6)
    assert np.linalg.norm(mesh.positions, axis=1).max() == pytest.approx(1, abs=1e-6)
    assert all(np.all(np.isfinite(a)) for a in (mesh.positions, mesh.normals, mesh.tangents, mesh.uvs))


@pytest.mark.parametrize("name", BUILTIN_NAMES)
def test_what_lacks_nothing_comes_back_with_the_papers_tangents(name: str) -> None:
    mesh = builtin_mesh(name)
    found, remarks = assemble([piece_of(mesh)], "x.obj")
    assert remarks == ()
    check_frames(found)
    _, numbers = np.unique(found.positions[found.triangles].round(5), axis=0, return_inverse=True)
    assert len(found.triangles) == len(mesh.triangles) and len(numbers)
    cosine = np.sum(found.tangents[found.triangles] * mesh.tangents[mesh.triangles], axis=2)
    # At a pole and where a grain breaks, a corner differs from what the formula has.
    assert np.mean(cosine > math.cos(math.radians(5))) > 0.99


def test_seams_of_a_garment_are_kept_apart() -> None:
    garment = skirt(wide=12, tall=40)
    found, _ = assemble([piece_of(garment)], "x.obj")
    again = split_at_seams(skirt_corners(garment))
    assert len(found.positions) == len(again.positions)
    np.testing.assert_allclose(found.tangents[found.triangles], again.tangents[again.triangles], atol=1e-4)


def skirt_corners(mesh: Mesh) -> CornerMesh:
    return CornerMesh(mesh.positions.round(6), mesh.uvs, mesh.triangles, mesh.triangles, mesh.normals)


@pytest.mark.parametrize("scale", [1e-200, 1e-12, 1, 1e12, 1e200, 1.7e308], ids="{:g}".format)
def test_any_unit_of_length_will_do(scale: float) -> None:
    mesh, remarks = assemble([square(positions=(SQUARE.astype(np.float64) - 0.5) * scale)], "x.obj")
    assert remarks == ()
    check_frames(mesh)
    np.testing.assert_allclose(mesh.tangents, np.tile([1, 0, 0], (4, 1)), atol=1e-6)


def test_missing_normals_are_derived_sharp_where_edges_are_sharp() -> None:
    mesh, remarks = assemble([Piece(CUBE, CUBE_SIDES)], "box.stl")
    assert remarks[0] == "box.stl: has no normals; derived from its triangles, sharp edges kept"
    assert np.all(np.abs(mesh.normals).max(axis=1) > 1 - 1e-6), "those of a box's six sides"
    check_frames(mesh)
    ball = sphere(24, 12)
    mesh, _ = assemble([Piece(ball.positions.astype(np.float64), ball.triangles.astype(np.int64))], "ball.ply")
    assert np.sum(mesh.normals * mesh.positions, axis=1).min() > math.cos(math.radians(4)), "round where it is round"


def test_missing_coordinates_are_laid_on_and_the_grain_is_level() -> None:
    ball = sphere(48, 24)
    piece = replace(piece_of(ball), uvs=None, uv_triangles=None)
    mesh, remarks = assemble([piece], "ball.ply")
    assert remarks == ("ball.ply: has no texture coordinates; laid on by a cylinder about y, grain level round it",)
    check_frames(mesh)
    np.testing.assert_allclose(mesh.tangents[:, 1], 0, atol=1e-6)
    # The sphere that comes along has the same grain by formula, but for its poles, which have none.
    off_pole = np.abs(mesh.positions[:, 1]) < 0.999
    east = np.stack([mesh.positions[:, 2], 0 * mesh.positions[:, 1], -mesh.positions[:, 0]], axis=1)
    assert np.min(np.sum(mesh.tangents * east, axis=1)[off_pole] / np.linalg.norm(east, axis=1)[off_pole]) > 0.999
    corners = mesh.uvs[mesh.triangles]
    assert np.ptp(corners[..., 0], axis=1).max() < 0.05, "no triangle goes the long way round"


@pytest.mark.parametrize("missing", ["u stands still", "all alike"])
def test_coordinates_without_extent_are_as_good_as_none(missing: str) -> None:
    uvs = UVS * ([0, 1] if missing == "u stands still" else [0, 0])
    mesh, remarks = assemble([square(uvs=uvs)], "x.obj")
    assert len(remarks) == 1 and "its texture coordinates have no extent in u; laid on" in remarks[0]
    check_frames(mesh)


def test_where_u_stands_still_in_a_part_the_grain_is_level_there_and_said() -> None:
    still = square(positions=SQUARE + np.array([3.0, 0, 0]), uvs=UVS * 0.0)
    mesh, remarks = assemble([square(uvs=UVS @ np.array([[0.0, 1], [-1, 0]])), still], "x.glb")
    assert remarks == ("x.glb: u does not vary around 4 of its 8 vertices; grain laid level there",)
    check_frames(mesh)
    right = mesh.positions[:, 0] > 0
    np.testing.assert_allclose(mesh.tangents[right], np.tile([1, 0, 0], (4, 1)), atol=1e-6)
    np.testing.assert_allclose(mesh.tangents[~right], np.tile([0, -1, 0], (4, 1)), atol=1e-6)


def test_a_part_without_coordinates_says_how_much_it_is() -> None:
    bare = square(positions=SQUARE + np.array([3.0, 0, 0]), uvs=None, uv_triangles=None)
    mesh, remarks = assemble([square(), bare], "x.glb")
    assert "2 of its 4 triangles have no texture coordinates" in remarks[0] and len(remarks) == 1
    check_frames(mesh)


@pytest.mark.parametrize("broken", [[0, 0, 0], [math.nan, 0, 1], [math.inf, 0, 0]], ids=str)
def test_a_normal_that_is_none_is_derived(broken: list[float]) -> None:
    normals = NORMALS.astype(np.float64)
    normals[2] = broken
    mesh, remarks = assemble([square(normals=normals)], "x.obj")
    assert remarks == ("x.obj: 33.3% of its corners have no normal; derived from its triangles, sharp edges kept",)
    np.testing.assert_allclose(mesh.normals, np.tile([0, 0, 1], (len(mesh.normals), 1)), atol=1e-6)


def test_triangles_are_turned_to_the_side_of_their_normals() -> None:
    mesh, remarks = assemble([square(normals=-NORMALS.astype(np.float64))], "x.obj")
    assert remarks == ("x.obj: 2 of its 2 triangles run against their normals; turned over",)
    corners = mesh.positions[mesh.triangles]
    assert np.all(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0)
    np.testing.assert_allclose(mesh.uvs[:, 0], mesh.positions[:, 0] / np.ptp(mesh.positions[:, 0]) + 0.5, atol=1e-6)


def test_triangles_without_area_are_left_out_and_said() -> None:
    slivers = np.array([[0, 0, 1], [0, 2, 2], [3, 3, 3]])
    triangles = np.concatenate([TRIANGLES, slivers])
    mesh, remarks = assemble([square(triangles=triangles, uv_triangles=triangles, normal_triangles=triangles)], "x.obj")
    assert remarks == ("x.obj: 3 of its 5 triangles have no area; left out",)
    assert len(mesh.triangles) == 2


def test_what_no_triangle_uses_does_not_matter() -> None:
    positions = np.concatenate([SQUARE.astype(np.float64), [[math.nan, 1e300, 0]]])
    mesh, remarks = assemble([square(positions=positions)], "x.obj")
    assert remarks == () and len(mesh.positions) == 4


@pytest.mark.parametrize(
    ("piece", "reason"),
    [
        (square(positions=SQUARE * np.float64(math.nan)), "4 of its 4 positions are no numbers"),
        (square(positions=SQUARE + np.array([math.inf, 0, 0])), "4 of its 4 positions are no numbers"),
        (square(uvs=UVS * np.float64(math.nan)), "texture coordinates are no numbers"),
        (square(uvs=UVS * np.float64(1e300)), "texture coordinates are no numbers, or beyond"),
        (square(positions=SQUARE * np.float64(0)), "no triangle with an area"),
        (square(positions=np.tile([3.0, 4, 5], (4, 1))), "no triangle with an area"),
        (square(positions=SQUARE * np.array([1.0, 0, 0])), "no triangle with an area"),
        (square(triangles=TRIANGLES + 1), "names positions that are not among its 4"),
        (square(triangles=TRIANGLES - 1), "names positions that are not among its 4"),
        (square(uv_triangles=TRIANGLES + 1), "names texture coordinates that are not among its 4"),
        (square(normal_triangles=TRIANGLES + 1), "names normals that are not among its 4"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_makes_no_mesh_is_refused(piece: Piece, reason: str) -> None:
    with pytest.raises(InputError, match=reason) as caught:
        assemble([piece], "x.obj")
    assert str(caught.value).startswith("x.obj: ")


def test_a_surface_folded_shut_still_has_normals() -> None:
    folded = np.array([[0, 1, 2], [0, 2, 1]])
    mesh, _ = assemble([Piece(SQUARE.astype(np.float64), folded)], "x.stl")
    check_frames(mesh)


def test_too_many_triangles_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_TRIANGLES", 3)
    with pytest.raises(InputError, match="has 4 triangles, 3 are the most"):
        assemble([square(), square()], "x.obj")


def test_the_grain_of_a_coarse_torus_is_close_to_its_formula() -> None:
    mesh, _ = assemble([piece_of(torus(48, 24))], "x.obj")
    ring = np.stack([mesh.positions[:, 2], 0 * mesh.positions[:, 0], -mesh.positions[:, 0]], axis=1)
    cosine = np.sum(ring * mesh.tangents, axis=1) / np.linalg.norm(ring, axis=1)
    assert cosine.min() > math.cos(math.radians(0.5))
