"""Decomposed MatCaps as the shader draws them."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.matcap.matcap_exr import write_matcap
from processing.matcap.model import DecomposedMatcap
from processing.mesh.builtin import sphere
from processing.mesh.model import Mesh
from processing.reference.decomposed_matcap import render_decomposed
from tests.processing.matcap.maps import analytic, sharp, soft
from tests.viewer.compare import codes_apart
from tests.viewer.scenes import MESHES, SIZE, with_occlusion
from tests.viewer.test_cli import SMALL, codes, run
from viewer.geometry import mesh_geometry
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.renderer import F32, Renderer
from viewer.view import Projection, View

VIEWS = [View(projection, yaw_deg=25, pitch_deg=35, fov_deg=50) for projection in Projection]
FRONT = View(Projection.ORTHOGRAPHIC)


def drawn(
    renderer: Renderer,
    matcap: DecomposedMatcap,
    mesh: Mesh,
    view: View,
    *,
    level: int | None = 0,
    occluded: bool = False,
) -> F32:
    with (
        renderer.upload(DecomposedMatcapMaterial, matcap) as material,
        renderer.upload(mesh_geometry, mesh) as geometry,
    ):
        return renderer.picture(material.look(level=level, occluded=occluded), geometry, view, size=SIZE)


@pytest.mark.parametrize("view", VIEWS, ids=lambda view: str(view.projection))
@pytest.mark.parametrize("name", MESHES)
def test_shader_and_reference_agree(renderer: Renderer, name: str, view: View) -> None:
    mesh = with_occlusion(MESHES[name])
    truth = render_decomposed(analytic(), mesh, view.camera(SIZE), SIZE, occluded=True)
    assert codes_apart(drawn(renderer, analytic(), mesh, view, occluded=True), truth) <= 2


@pytest.mark.parametrize("kind", TableNormal)
def test_with_every_table_normal(renderer: Renderer, kind: TableNormal) -> None:
    matcap = analytic(table_normal=kind)
    truth = render_decomposed(matcap, MESHES["torus"], VIEWS[1].camera(SIZE), SIZE)
    assert codes_apart(drawn(renderer, matcap, MESHES["torus"], VIEWS[1]), truth) <= 2


@pytest.mark.parametrize("slopes", [(0.0, 0.0), (0.4, 1.0), (1.0, 0.2)], ids=str)
def test_a_sphere_shows_the_light_at_its_angle_times_one_and_the_slope(
    renderer: Renderer, slopes: tuple[float, float]
) -> None:
    """No map in this truth: the formula of the light itself, at directions worked out here."""
    picture = drawn(renderer, analytic(256, slopes=slopes), sphere(256, 128), FRONT)
    rows, columns = np.nonzero(picture[..., 3])
    scale = 2 * 1.06 / min(SIZE)
    x, y = (columns + 0.5 - SIZE[0] / 2) * scale, -(rows + 0.5 - SIZE[1] / 2) * scale
    radius = np.hypot(x, y)
    inside = radius < 0.97
    rows, columns, x, y, radius = (values[inside] for values in (rows, columns, x, y, radius))
    light = np.zeros((len(x), 3))
    for slope, lobes, colour in zip(slopes, (soft, sharp), ((0.8, 0.5, 0.4), (0.6, 0.6, 0.7)), strict=True):
        angle = np.arcsin(radius) * (1 + slope)
        across = np.sin(angle) / np.maximum(radius, 1e-12)
        light += lobes(np.stack([x * across, y * across, np.cos(angle)], axis=-1)) * np.array(colour)
    assert light.std() > 0.05
    assert np.quantile(np.abs(picture[rows, columns, :3] - light), 0.999) < 0.012


def test_no_seam_shows_between_front_and_back(renderer: Renderer) -> None:
    """Also with smaller copies, whose choice must not jump where the maps meet."""
    even = analytic(64, slopes=(1.0, 1.0))
    white = np.full((64, 64, 3), 0.5, np.float32)
    low = dataclasses.replace(even.low, front=white, back=white, base_colour=(1, 1, 1))
    high = dataclasses.replace(even.high, base_colour=(0, 0, 0))
    picture = drawn(renderer, dataclasses.replace(even, low=low, high=high), MESHES["torus"], VIEWS[1], level=None)
    np.testing.assert_allclose(
        picture[picture[..., 3] > 0], [[0.5, 0.5, 0.5, 1]] * int(picture[..., 3].sum()), atol=1e-6
    )
    fitting, full = (drawn(renderer, even, sphere(), FRONT, level=level) for level in (None, 0))
    assert np.quantile(np.abs(fitting - full).max(axis=-1), 0.995) < 0.03


@pytest.mark.parametrize("level", [-1, 8])
def test_a_level_that_is_not_there_is_refused(renderer: Renderer, level: int) -> None:
    with renderer.upload(DecomposedMatcapMaterial, analytic(96)) as material:
        material.look(level=6)
        with pytest.raises(InputError, match="no mip level"):
            material.look(level=level)


@pytest.mark.parametrize(
    ("front", "reason"),
    [
        (np.zeros((1, 20_000, 3), np.float32), "is no square map"),
        (np.full((4, 4, 3), np.inf, np.float32), "no numbers; mend"),
    ],
    ids=["not square", "infinite"],
)
def test_maps_that_cannot_be_drawn_are_refused(renderer: Renderer, front: F32, reason: str) -> None:
    broken = dataclasses.replace(analytic(4), low=dataclasses.replace(analytic(4).low, front=front))
    with pytest.raises(InputError, match=reason), renderer.upload(DecomposedMatcapMaterial, broken):
        pass


def test_maps_larger_than_the_driver_takes_are_refused(renderer: Renderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("moderngl.Context.info", {"GL_MAX_TEXTURE_SIZE": 64})
    with (
        pytest.raises(InputError, match="maps of 96 × 96 texels, but this graphics driver ends at 64; shrink"),
        renderer.upload(DecomposedMatcapMaterial, analytic(96)),
    ):
        pass


def test_the_command_draws_one(tmp_path: Path) -> None:
    write_matcap(tmp_path / "x.matcap.exr", analytic(32))
    run(tmp_path / "x.matcap.exr", "-o", tmp_path / "x.png", "--mesh", "cloth", *SMALL)
    assert codes(tmp_path / "x.png").std() > 10
    for option, reason in ((["--softness", "3"], "has its light in it"), (["--turn", "9"], "no grain")):
        with pytest.raises(InputError, match=reason):
            run(tmp_path / "x.matcap.exr", "-o", tmp_path / "y.png", *option)
