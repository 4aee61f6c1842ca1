"""The meshes that come along: unit frames, consistent sides, and ∇U as the paper computes it."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.mesh.builtin import BUILTIN_NAMES, builtin_mesh, cloth, pillow, ribbon, sphere, torus
from processing.mesh.model import Mesh
from processing.mesh.tangents import vertex_tangents

CLOSED = ("torus", "sphere", "pillow")


@pytest.fixture(params=BUILTIN_NAMES)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return builtin_mesh(request.param)


def faces(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unit normals and areas of the triangles."""
    corners = mesh.positions.astype(np.float64)[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1)
    return across / np.maximum(length, 1e-30)[:, None], length / 2


def test_arrays_are_as_promised(mesh: Mesh) -> None:
    count = len(mesh.positions)
    arrays = [field.name for field in dataclasses.fields(mesh) if field.name != "occlusion"]
    shapes = {name: getattr(mesh, name).shape for name in arrays}
    assert shapes == {
        "positions": (count, 3),
        "normals": (count, 3),
        "tangents": (count, 3),
        "uvs": (count, 2),
        "triangles": (len(mesh.triangles), 3),
    }
    assert {mesh.positions.dtype, mesh.normals.dtype, mesh.tangents.dtype, mesh.uvs.dtype} == {np.dtype(np.float32)}
    assert mesh.triangles.dtype == np.int32
    assert mesh.triangles.min() == 0 and mesh.triangles.max() == count - 1


def test_a_mesh_fills_the_unit_sphere(mesh: Mesh) -> None:
    assert np.linalg.norm(mesh.positions, axis=1).max() == pytest.approx(1, abs=1e-6)


def test_frames_are_orthonormal(mesh: Mesh) -> None:
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(mesh.tangents, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(np.sum(mesh.normals * mesh.tangents, axis=1), 0, atol=1e-6)


def test_triangles_and_normals_agree_on_the_side(mesh: Mesh) -> None:
    normals, areas = faces(mesh)
    agreement = np.sum(normals * mesh.normals[mesh.triangles].mean(axis=1), axis=1)[areas > 1e-10]
    assert agreement.min() > 0.3, "no triangle is folded over"
    assert np.quantile(agreement, 0.01) > 0.9, "only where a sleeve leaves the body do they differ by much"


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_mesh_has_its_normals_outside(name: str) -> None:
    mesh = builtin_mesh(name)
    normals, areas = faces(mesh)
    centres = mesh.positions.astype(np.float64)[mesh.triangles].mean(axis=1)
    volume = np.sum(normals * centres * areas[:, None]) / 3
    assert volume > 0
    np.testing.assert_allclose(np.sum(normals * areas[:, None], axis=0), 0, atol=1e-5)


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_mesh_has_no_crack(name: str) -> None:
    """Every edge, told by the very bits of its ends, is run through once in each direction."""
    mesh = builtin_mesh(name)
    _, places = np.unique(mesh.positions, axis=0, return_inverse=True)
    corners = places.reshape(-1)[mesh.triangles]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    there = np.unique(edges, axis=0)
    assert len(there) == len(edges)
    np.testing.assert_array_equal(there, np.unique(edges[:, ::-1], axis=0))


def test_volumes_are_those_of_the_formulas() -> None:
    for mesh, volume in ((sphere(), 4 / 3 * np.pi), (torus(), 2 * np.pi**2 * 0.36**2 / 1.36**3)):
        normals, areas = faces(mesh)
        centres = mesh.positions.astype(np.float64)[mesh.triangles].mean(axis=1)
        assert np.sum(normals * centres * areas[:, None]) / 3 == pytest.approx(volume, rel=3e-3)


@pytest.mark.parametrize(
    ("mesh", "usual_deg", "worst_deg"),
    [
        pytest.param(torus(), 0.01, 1.0, id="torus"),
        pytest.param(sphere(), 0.01, 1.5, id="sphere"),
        pytest.param(cloth(), 0.05, 6.0, id="cloth"),
        pytest.param(ribbon(), 0.2, 1.0, id="ribbon"),
        pytest.param(pillow(), 0.05, 2.0, id="pillow"),
    ],
)
def test_averaged_gradients_agree_with_the_derivatives(mesh: Mesh, usual_deg: float, worst_deg: float) -> None:
    """Borders see triangles on one side only, so that they are worst."""
    tangents = vertex_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles)
    apart = np.linalg.norm(tangents.astype(np.float64) - mesh.tangents, axis=1)
    angles_deg = np.degrees(2 * np.arcsin(np.minimum(apart / 2, 1)))
    assert np.median(angles_deg) < usual_deg
    assert angles_deg.max() < worst_deg


def test_the_gradient_follows_u_not_the_grid() -> None:
    """In a sheared grid u grows along x, though the grid lines of constant v lean."""
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    uvs = np.array([[0, 0], [1, 1], [1, 2], [0, 1]], np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (4, 1))
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    np.testing.assert_allclose(vertex_tangents(positions, normals, uvs, triangles), [[1, 0, 0]] * 4, atol=1e-7)


def test_a_large_triangle_weighs_more_than_a_small_one() -> None:
    positions = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [-1, 0, 0], [0, -1, 0]], np.float32)
    uvs = np.array([[0, 0], [3, 0], [0, 0], [0, 0], [-1, 0]], np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (5, 1))
    tangents = vertex_tangents(positions, normals, uvs, np.array([[0, 1, 2], [0, 3, 4]], np.int32))
    np.testing.assert_allclose(tangents[0], np.array([9, 1, 0]) / np.sqrt(82), atol=1e-6)


def test_a_mesh_without_u_has_no_tangents() -> None:
    flat = torus(8, 6)
    with pytest.raises(InputError, match="u does not vary around 63 of 63"):
        vertex_tangents(flat.positions, flat.normals, np.zeros_like(flat.uvs), flat.triangles)


def test_an_unknown_name_is_answered_with_the_known_ones() -> None:
    with pytest.raises(InputError, match=r"mesh 'teapot': .* use one of torus, sphere, cloth, ribbon, pillow"):
        builtin_mesh("teapot")


def test_cloth_keeps_its_threads_nearly_as_long_as_they_are() -> None:
    """Half of a thread's steps are within a fifth of their length: it hangs, it is not rubber."""
    sheet = cloth(120)
    grid = sheet.positions.reshape(121, 121, 3)
    steps = np.linalg.norm(np.diff(grid, axis=1), axis=-1)
    middle = np.median(steps)
    assert np.quantile(np.abs(steps / middle - 1), 0.5) < 0.2
