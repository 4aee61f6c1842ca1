"""Ambient occlusion against closed forms, against plain arithmetic, and its cache."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh import occlusion_cache
from processing.mesh.builtin import pillow, sphere, torus
from processing.mesh.grids import join
from processing.mesh.model import Mesh
from processing.mesh.occlusion import _LIFT, ambient_occlusion, cosine_directions, frames_about
from processing.mesh.occlusion_cache import with_occlusion

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def bare(positions: F64, normals: F64, triangles: NDArray[np.integer]) -> Mesh:
    count = len(positions)
    return Mesh(
        positions.astype(np.float32),
        normals.astype(np.float32),
        np.zeros((count, 3), np.float32),
        np.zeros((count, 2), np.float32),
        triangles.astype(np.int32),
    )


def floor(points: F64) -> Mesh:
    """Points on the plane y = 0, seen from above, each in a tiny triangle."""
    corners = np.array([[0, 0, 0], [0, 0, 1e-4], [1e-4, 0, 0]])
    positions = (points[:, None] + corners).reshape(-1, 3)
    return bare(positions, np.tile([0.0, 1, 0], (len(positions), 1)), np.arange(len(positions)).reshape(-1, 3))


def ball(radius: float, height: float) -> Mesh:
    unit = sphere(72, 36)
    positions = unit.positions.astype(np.float64) * radius + [0, height, 0]
    return bare(positions, unit.normals.astype(np.float64), unit.triangles)


def inside_of(opening: float) -> Mesh:
    """A sphere seen from inside, without the cap above y = 1 − 2·opening, which is that share of its area."""
    polar = np.linspace(math.acos(1 - 2 * opening), math.pi, 41)
    azimuth = np.linspace(0, math.tau, 81)
    azimuths, polars = np.meshgrid(azimuth, polar)
    positions = np.stack(
        [np.sin(polars) * np.sin(azimuths), np.cos(polars), np.sin(polars) * np.cos(azimuths)], axis=-1
    ).reshape(-1, 3)
    first = (np.arange(40)[:, None] * 81 + np.arange(80)).reshape(-1)
    triangles = np.concatenate(
        [np.stack([first, first + 1, first + 81], axis=1), np.stack([first + 1, first + 82, first + 81], axis=1)]
    )
    return bare(positions, -positions, triangles)


def test_a_convex_surface_is_open_everywhere() -> None:
    np.testing.assert_array_equal(ambient_occlusion(sphere(), rays=64), 1)


@pytest.mark.parametrize("radius", [0.2, 0.45])
def test_a_plane_under_a_sphere(radius: float) -> None:
    """All of the sphere is above the plane: it hides (R/d)² cos θ."""
    height = 0.5
    ways = np.array([0, 0.1, 0.25, 0.5, 1, 2])
    points = floor(np.stack([ways, 0 * ways, 0.3 * ways], axis=1))
    found = ambient_occlusion(join(points, ball(radius, height)), rays=512)[: 3 * len(ways) : 3]
    away = np.hypot(np.hypot(ways, 0.3 * ways), height)
    np.testing.assert_allclose(found, 1 - (radius / away) ** 2 * height / away, atol=0.004)


@pytest.mark.parametrize("opening", [0.05, 0.25, 0.5])
def test_inside_of_a_sphere_every_place_sees_the_opening_alike(opening: float) -> None:
    """By its share of the sphere's area, wherever it is."""
    mesh = inside_of(opening)
    found = ambient_occlusion(mesh, rays=512)
    deep = mesh.positions[:, 1] < 1 - 2 * opening - 0.1  # at the rim the facets are not quite the sphere
    assert np.abs(found[deep] - opening).mean() < 0.004
    assert np.abs(found[deep] - opening).max() < 0.02


def test_a_closed_room_is_dark() -> None:
    unit = sphere(64, 32)
    walls = bare(unit.positions.astype(np.float64), -unit.normals.astype(np.float64), unit.triangles)
    assert ambient_occlusion(walls, rays=64).max() == 0


def test_what_is_out_of_reach_does_not_count() -> None:
    points, above = floor(np.zeros((1, 3))), ball(0.3, 0.5)
    near, far = (ambient_occlusion(join(points, above), rays=256, reach=reach)[0] for reach in (0.15, 10))
    assert near == 1 > far


def test_the_library_agrees_with_plain_arithmetic() -> None:
    mesh, rays = torus(16, 8), 40
    found = ambient_occlusion(mesh, rays=rays)
    hits = brute_force(mesh, rays)
    assert found.min() < 0.8
    # A ray through an edge may go either way.
    assert np.abs(1 - hits.mean(axis=1) - found).max() <= 1.01 / rays
    assert np.mean(np.abs(1 - hits.mean(axis=1) - found) > 1e-6) < 0.05


def brute_force(mesh: Mesh, rays: int) -> NDArray[np.bool_]:
    """Every ray against every triangle, by Cramer's rule, (V, rays)."""
    directions = frames_about(mesh.normals.astype(np.float64)) @ cosine_directions(rays).T
    origins = mesh.positions.astype(np.float64) + mesh.normals * _LIFT
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    hits = np.zeros((len(origins), rays), np.bool_)
    for vertex, (origin, along) in enumerate(zip(origins, directions.transpose(0, 2, 1), strict=True)):
        cross = np.cross(along[:, None], second)
        determinant = np.sum(cross * first, axis=2)
        determinant[np.abs(determinant) < 1e-14] = np.inf
        to_origin = origin - corners[:, 0]
        a = np.sum(cross * to_origin, axis=2) / determinant
        other = np.cross(to_origin, first)
        b = along @ other.T / determinant
        way = np.sum(other * second, axis=1) / determinant
        hits[vertex] = np.any((a >= 0) & (b >= 0) & (a + b <= 1) & (way > 0), axis=1)
    return hits


def test_directions_weigh_by_the_cosine() -> None:
    """The mean of a cosine-weighted half sphere is 2/3 along its pole, nothing aside; each is a unit vector."""
    directions = cosine_directions(4096)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(directions.mean(axis=0), [0, 0, 2 / 3], atol=1e-3)


def test_frames_are_rotations_onto_the_normal() -> None:
    normals = np.random.default_rng(1).normal(size=(50, 3))
    normals = np.concatenate([normals / np.linalg.norm(normals, axis=1, keepdims=True), np.eye(3), -np.eye(3)])
    frames = frames_about(normals)
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), np.tile(np.eye(3), (56, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frames), 1)
    np.testing.assert_array_equal(frames[:, :, 2], normals)


@pytest.mark.parametrize(("rays", "reach"), [(0, 1.0), (8, 0.0), (8, math.nan)])
def test_no_rays_are_refused(rays: int, reach: float) -> None:
    with pytest.raises(InputError, match="tell nothing"):
        ambient_occlusion(pillow(8), rays=rays, reach=reach)


class Counted:
    """The caster, and how often it was asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls = 0
        monkeypatch.setattr(occlusion_cache, "ambient_occlusion", self)

    def __call__(self, mesh: Mesh, *, rays: int, reach: float) -> F32:
        self.calls += 1
        return ambient_occlusion(mesh, rays=rays, reach=reach)


def test_a_mesh_is_cast_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counted = Counted(monkeypatch)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first, again = (with_occlusion(torus(16, 8), rays=16) for _ in range(2))
    assert counted.calls == 1
    assert first.occlusion is not None and again.occlusion is not None
    assert again.occlusion.dtype == np.float32
    np.testing.assert_array_equal(first.occlusion, again.occlusion)
    with_occlusion(torus(16, 8), rays=17)
    with_occlusion(torus(16, 8), rays=16, reach=1)
    with_occlusion(torus(16, 9), rays=16)
    assert counted.calls == 4, "another mesh or other rays are not the same"
    assert len(list((tmp_path / "litrig" / "occlusion").iterdir())) == 4, "and nothing half-written beside them"


@pytest.mark.parametrize("harm", ["cut", "bit", "empty"])
def test_a_damaged_file_is_cast_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, harm: str) -> None:
    whole = with_occlusion(torus(16, 8), rays=16, folder=tmp_path).occlusion
    (file,) = tmp_path.iterdir()
    content = bytearray(file.read_bytes())
    content[5] ^= 1
    file.write_bytes({"cut": file.read_bytes()[:-9], "bit": bytes(content), "empty": b""}[harm])
    counted = Counted(monkeypatch)
    for _ in range(2):
        np.testing.assert_array_equal(with_occlusion(torus(16, 8), rays=16, folder=tmp_path).occlusion, whole)
    assert counted.calls == 1


def test_a_folder_that_cannot_be_written_is_done_without(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert with_occlusion(torus(16, 8), rays=16, folder=tmp_path / "file" / "cache").occlusion is not None


def test_what_was_not_used_for_longest_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    meshes = [torus(16, tube) for tube in (6, 7, 8)]
    monkeypatch.setattr(occlusion_cache, "LIMIT_BYTES", 2 * (17 * 9 * 4 + 32))
    for mesh in meshes[:2]:
        with_occlusion(mesh, rays=4, folder=tmp_path)
    with_occlusion(meshes[0], rays=4, folder=tmp_path)
    with_occlusion(meshes[2], rays=4, folder=tmp_path)
    counted = Counted(monkeypatch)
    with_occlusion(meshes[0], rays=4, folder=tmp_path)
    assert counted.calls == 0
    with_occlusion(meshes[1], rays=4, folder=tmp_path)
    assert counted.calls == 1
