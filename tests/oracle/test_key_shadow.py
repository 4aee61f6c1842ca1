"""Where the shadow map keeps the key light from a mesh, a path tracer does so too."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from processing.amc.model import Amc
from processing.mesh.builtin import builtin_mesh
from processing.mesh.grids import fit_unit_sphere, grid, grid_mesh, join
from processing.mesh.model import Mesh
from viewer.geometry import mesh_geometry
from viewer.key_shadow import KeyShadow, key_direction
from viewer.materials.amc import AmcMaterial
from viewer.renderer import Renderer
from viewer.view import Projection, View

Mask = NDArray[np.bool_]
SIDE_PX = 240
BORDER_PX = 2
"""A mask's border is as uncertain as a pixel of each: its own, and the one that the tracer jitters in."""
WHITE = Amc(np.ones((1, 2, 2, 3), np.float32), np.ones((1, 2, 2), bool), "isotropic")
BLACK = dataclasses.replace(WHITE, slices=np.zeros_like(WHITE.slices))


def over_a_floor(mesh: Mesh) -> Mesh:
    """The mesh, upright, a little above a square floor, all within the unit sphere again."""
    side, low = 1.8, float(mesh.positions[:, 1].min()) - 0.15
    u, v = grid(8, 8)
    corners = np.stack([(u - 0.5) * 2 * side, np.full_like(u, low), (0.5 - v) * 2 * side], axis=-1)
    up, along = np.zeros_like(corners), np.zeros_like(corners)
    up[..., 1], along[..., 0] = 1, 1
    return fit_unit_sphere(join(mesh, grid_mesh(corners, up, along, u, v)))


MESHES = {"cloth": builtin_mesh("cloth"), "torus over a floor": over_a_floor(builtin_mesh("torus"))}


def drawn_masks(mesh: Mesh, view: View, key: tuple[float, float]) -> tuple[Mask, Mask]:
    """What the mesh covers, and what of it the key light reaches: white where the lit table shows."""
    with (
        Renderer() as renderer,
        renderer.upload(AmcMaterial, WHITE) as lit,
        renderer.upload(AmcMaterial, BLACK) as unlit,
        renderer.upload(mesh_geometry, mesh) as geometry,
        renderer.upload(KeyShadow) as shadow,
    ):
        look = lit.keyed_look(unlit, shadow.cast(renderer, geometry, view, key))
        picture = renderer.picture(look, geometry, view, size=(SIDE_PX, SIDE_PX))
    return picture[..., 3] > 0, picture[..., 0] > 0.5


def traced_masks(mesh: Mesh, view: View, key: tuple[float, float], variant: str, folder: Path) -> tuple[Mask, Mask]:
    """The same by mitsuba: a matt mesh under one distant lamp, and under light from everywhere."""
    import mitsuba as mi

    mi.set_variant(variant)
    camera = view.camera((SIDE_PX, SIDE_PX))
    turned = mesh.positions @ camera.view_from_object.T
    write_ply(folder / "mesh.ply", turned, mesh.normals @ camera.view_from_object.T, mesh.triangles)
    look = mi.ScalarTransform4f().look_at([0, 0, camera.eye_distance or 4], [0, 0, 0], [0, 1, 0])
    if camera.eye_distance is None:
        half = 1 / float(camera.clip_from_view[0, 0])
        sensor = {"type": "orthographic", "to_world": look @ mi.ScalarTransform4f().scale([half, half, 1])}
    else:
        sensor = {"type": "perspective", "to_world": look, "fov": view.fov_deg}
    film = {"type": "hdrfilm", "width": SIDE_PX, "height": SIDE_PX, "rfilter": {"type": "box"}}
    towards = key_direction(key)
    lamps = (
        {"type": "constant"},
        {"type": "directional", "direction": (-towards).tolist(), "irradiance": 1.0},
    )
    masks = []
    for lamp in lamps:
        scene = mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "direct", "hide_emitters": True},
                "sensor": {**sensor, "film": film, "sampler": {"type": "independent", "sample_count": 4}},
                "lamp": lamp,
                "mesh": {
                    "type": "ply",
                    "filename": str(folder / "mesh.ply"),
                    "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse"}},
                },
            }
        )
        masks.append(np.array(mi.render(scene, spp=4))[..., :3].mean(axis=-1) > 1e-4)
    return masks[0], masks[1]


def write_ply(
    path: Path, positions: NDArray[np.floating], normals: NDArray[np.floating], triangles: NDArray[np.int32]
) -> None:
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n{names}"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(triangles), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, triangles
    vertices = np.concatenate([positions, normals], axis=1).astype("<f4")
    path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())


@pytest.mark.parametrize("projection", Projection)
@pytest.mark.parametrize("name", MESHES)
def test_the_shadow_of_the_key_light_is_the_path_tracers(
    variant: str, tmp_path: Path, name: str, projection: Projection
) -> None:
    key, view = (-0.6, 0.62), View(projection, yaw_deg=25, pitch_deg=30, fov_deg=40)
    covered, lit = drawn_masks(MESHES[name], view, key)
    truly_covered, truly_lit = traced_masks(MESHES[name], view, key, variant, tmp_path)
    assert np.mean(covered != truly_covered) < 0.02, "both see the mesh in one place"
    inside = ndimage.binary_erosion(covered & truly_covered, iterations=BORDER_PX)
    near = ndimage.binary_dilation(truly_lit, iterations=BORDER_PX) & ndimage.binary_dilation(
        ~truly_lit, iterations=BORDER_PX
    )
    sure = inside & ~near
    assert 0.05 < np.mean(~truly_lit[sure]) < 0.6, "there is shadow and light"
    assert sure.sum() > 0.6 * inside.sum()
    agreed = float(np.mean(lit[sure] == truly_lit[sure]))
    assert agreed >= 0.98
