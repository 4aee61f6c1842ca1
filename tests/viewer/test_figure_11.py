"""The AMC paper's figure 11: at a seam of sewn cloth the light jumps with the AMC, and not with its plain MatCap."""

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.amc.isotropic import isotropic_matcap
from processing.mesh.model import Mesh
from processing.mesh.sewn import skirt
from processing.reference.camera import Camera
from processing.reference.surface import in_view, unit, visible_surface
from tests.viewer.analytic import brushed_amc
from viewer.geometry import mesh_geometry
from viewer.materials.amc import AmcMaterial
from viewer.materials.matcap import MatcapMaterial
from viewer.renderer import F32, Renderer
from viewer.view import View

F64 = NDArray[np.float64]
SIZE = (420, 420)
STEP = 0.018
"""From place to place across a seam, in radii of the mesh: about three pixels."""


def seam_vertices(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of vertices at one place with one normal, between whose tangents lie more than 20°, counted as grain is."""
    order = np.lexsort(mesh.positions.T)
    first, second = order[:-1], order[1:]
    same = np.all(mesh.positions[first] == mesh.positions[second], axis=1)
    smooth = np.sum(mesh.normals[first] * mesh.normals[second], axis=1) > 0.999
    along = np.abs(np.sum(mesh.tangents[first] * mesh.tangents[second], axis=1))
    chosen = same & smooth & (along < np.cos(np.radians(20)))
    return first[chosen], second[chosen]


def into_the_piece(mesh: Mesh) -> F64:
    """Unit vectors (V, 3) from vertices towards the middle of their own triangles, all on one side of a seam."""
    middles = mesh.positions[mesh.triangles].astype(np.float64).mean(axis=1)
    sums = np.zeros((len(mesh.positions), 3))
    for corner in range(3):
        np.add.at(sums, mesh.triangles[:, corner], middles - mesh.positions[mesh.triangles[:, corner]])
    return unit(sums)


def read_at(picture: F32, points: F64, camera: Camera) -> tuple[F64, F64]:
    """Return the light (N,) at points of the surface, nearest pixel, and each pixel's column and row (N, 2)."""
    clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ camera.clip_from_view.T
    places = clip[:, :2] / clip[:, 3:]
    columns = np.floor((places[:, 0] + 1) / 2 * SIZE[0]).astype(int)
    rows = np.floor((1 - places[:, 1]) / 2 * SIZE[1]).astype(int)
    light: F64 = picture[rows, columns, :3].astype(np.float64).mean(axis=-1)
    return light, np.stack([columns, rows], axis=1)


def jumps(picture: F32, mesh: Mesh, view: View) -> tuple[F64, F64]:
    """Return the change of light over every visible place of a seam (N,), and over as long a way beside it."""
    camera = view.camera(SIZE)
    first, second = seam_vertices(mesh)
    inwards = in_view(into_the_piece(mesh), camera)
    seam = in_view(mesh.positions, camera)[first]
    facing = np.sum(in_view(mesh.normals, camera)[first] * camera.to_eye(seam), axis=1) > 0.45
    first, second, seam = first[facing], second[facing], seam[facing]
    # One place on this side of the seam, one on the other, and a second one of each farther off.
    ways = [seam + side * STEP for side in (inwards[first] / 2, inwards[second] / 2)]
    ways += [seam + side * STEP * 1.5 for side in (inwards[first], inwards[second])]
    surface = visible_surface(mesh, camera, SIZE)
    depth = np.full((SIZE[1], SIZE[0]), -np.inf)
    depth[surface.seen.rows, surface.seen.columns] = surface.points[:, 2]
    lights, visible = [], np.ones(len(seam), bool)
    for way in ways:
        light, pixels = read_at(picture, way, camera)
        visible &= np.abs(depth[pixels[:, 1], pixels[:, 0]] - way[:, 2]) < 0.05
        lights.append(light)
    over = np.abs(lights[0] - lights[1])
    beside = (np.abs(lights[0] - lights[2]) + np.abs(lights[1] - lights[3])) / 2
    return over[visible], beside[visible]


@pytest.mark.parametrize("yaw_deg", [0, 35])
def test_the_light_jumps_at_seams_with_the_amc_alone(renderer: Renderer, yaw_deg: float) -> None:
    amc, mesh, view = brushed_amc(64, 64), skirt(24, 60), View(yaw_deg=yaw_deg, pitch_deg=20)
    with (
        renderer.upload(AmcMaterial, amc) as anisotropic,
        renderer.upload(MatcapMaterial, isotropic_matcap(amc)) as plain,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        with_grain, without = (
            jumps(renderer.picture(material.look(), geometry, view, size=SIZE), mesh, view)
            for material in (anisotropic, plain)
        )
    assert len(with_grain[0]) == len(without[0]) > 100
    jumping, smooth = (np.median(over) / np.median(beside) for over, beside in (with_grain, without))
    assert jumping > 3
    assert smooth < 1.3
    assert with_grain[0].mean() > 2.5 * without[0].mean()
