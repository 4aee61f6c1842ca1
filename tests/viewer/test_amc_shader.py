"""The shader draws what the NumPy reference says, to two codes of 255."""

import dataclasses
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.amc.files.ktx2 import read_levels, write_amc
from processing.amc.mips import mip_chain
from processing.amc.model import Amc, Invariance, TangentAngle
from processing.mesh.builtin import builtin_mesh, cloth, ribbon, torus
from processing.reference.amc import render_amc
from processing.reference.display import display_codes
from tests.viewer.analytic import brushed_amc
from viewer.materials.amc import amc_picture
from viewer.renderer import Renderer
from viewer.view import Projection, View

SIZE = (180, 150)
MESHES = {"torus": torus(96, 48), "cloth": cloth(120), "ribbon": ribbon(200, 12)}
MATERIALS: list[tuple[Invariance, TableNormal]] = [
    (1, TableNormal.RECTIFIED),
    (2, TableNormal.RECTIFIED),
    (3, TableNormal.RECTIFIED),
    ("isotropic", TableNormal.RECTIFIED),
    (2, TableNormal.VIEW),
    (2, TableNormal.CAMERA),
]


@pytest.mark.parametrize("level", [0, 2])
@pytest.mark.parametrize("projection", Projection)
@pytest.mark.parametrize(("invariance", "table_normal"), MATERIALS, ids=str)
@pytest.mark.parametrize("mesh_name", MESHES)
def test_shader_and_reference_agree(
    renderer: Renderer,
    mesh_name: str,
    invariance: Invariance,
    table_normal: TableNormal,
    projection: Projection,
    level: int,
) -> None:
    amc = brushed_amc(32, 1 if invariance == "isotropic" else 30, invariance, table_normal)
    view = View(projection, yaw_deg=25, pitch_deg=35, fov_deg=50)
    mesh = MESHES[mesh_name]
    drawn = display_codes(amc_picture(renderer, amc, mesh, view, size=SIZE, level=level)).astype(int)
    truth = display_codes(render_amc(amc, mesh, view.camera(SIZE), SIZE, level=level)).astype(int)
    covered = (drawn[..., 3] > 0) | (truth[..., 3] > 0)
    assert covered.sum() > 1500
    assert truth[covered][:, :3].std() > 15, "a picture that shows the material"
    apart = np.abs(drawn - truth).max(axis=-1)[covered]
    assert np.quantile(apart, 0.999) <= 2


@pytest.mark.parametrize("projection", Projection)
def test_an_angle_in_the_surface_is_looked_up_as_the_reference_does(renderer: Renderer, projection: Projection) -> None:
    in_picture = brushed_amc(32, 30, 4)
    amc = replace(in_picture, tangent_angle=TangentAngle.SURFACE)
    view = View(projection, yaw_deg=25, pitch_deg=35, fov_deg=50)
    drawn, other = (
        display_codes(amc_picture(renderer, table, MESHES["torus"], view, size=SIZE, level=0)).astype(int)
        for table in (amc, in_picture)
    )
    truth = display_codes(render_amc(amc, MESHES["torus"], view.camera(SIZE), SIZE, level=0)).astype(int)
    covered = (drawn[..., 3] > 0) | (truth[..., 3] > 0)
    assert np.quantile(np.abs(drawn - truth).max(axis=-1)[covered], 0.999) <= 2
    assert np.abs(drawn - other).max() > 20, "the two angles differ on tilted normals"


@pytest.mark.parametrize("projection", Projection)
def test_table_normals_differ_in_perspective_alone(renderer: Renderer, projection: Projection) -> None:
    """Otherwise agreement under all three would prove nothing."""
    pictures = [
        amc_picture(
            renderer,
            brushed_amc(32, 30, 2, kind),
            MESHES["torus"],
            View(projection, pitch_deg=35, fov_deg=50),
            size=SIZE,
            level=0,
        )
        for kind in TableNormal
    ]
    apart = [np.abs(first - second).max() for first, second in pairwise(pictures)]
    if projection is Projection.ORTHOGRAPHIC:
        assert max(apart) < 1e-3
    else:
        assert min(apart) > 0.05


def test_the_same_picture_has_the_same_bytes() -> None:
    amc, view = brushed_amc(32, 32), View(pitch_deg=30)
    pictures = []
    for _ in range(2):
        with Renderer() as fresh:
            pictures += [amc_picture(fresh, amc, torus(48, 24), view, size=SIZE).tobytes() for _ in range(2)]
    assert len(set(pictures)) == 1


def test_two_renderers_do_not_disturb_each_other(renderer: Renderer) -> None:
    amc, mesh, view = brushed_amc(16, 8), torus(24, 12), View()
    before = amc_picture(renderer, amc, mesh, view, size=SIZE)
    with Renderer() as other:
        there = amc_picture(other, amc, mesh, view, size=(40, 40))
        here = amc_picture(renderer, amc, mesh, view, size=SIZE)
        assert there.tobytes() == amc_picture(other, amc, mesh, view, size=(40, 40)).tobytes()
    after = amc_picture(renderer, amc, mesh, view, size=SIZE)
    assert before.tobytes() == here.tobytes() == after.tobytes()


@pytest.mark.parametrize("level", range(6))
def test_every_level_is_uploaded_as_it_is(renderer: Renderer, level: int) -> None:
    """Each level in a colour of its own: reading level n gives colour n, whatever the card would have averaged."""
    amc = brushed_amc(20, 12)
    levels = [
        dataclasses.replace(stored, colours=np.full_like(stored.colours, (number + 1) / 8))
        for number, stored in enumerate(mip_chain(amc))
    ]
    level = min(level, len(levels) - 1)
    picture = amc_picture(renderer, amc, MESHES["torus"], View(), size=(60, 60), levels=levels, level=level)
    np.testing.assert_array_equal(picture[picture[..., 3] > 0][:, :3], (level + 1) / 8)


def test_a_small_picture_is_read_from_small_levels(renderer: Renderer) -> None:
    amc = brushed_amc(64, 64)
    marked = mip_chain(amc)
    marked[0] = dataclasses.replace(marked[0], colours=np.full_like(marked[0].colours, 8))
    size = (24, 24)
    assert amc_picture(renderer, amc, MESHES["torus"], View(), size=size, levels=marked)[..., :3].max() < 4
    assert amc_picture(renderer, amc, MESHES["torus"], View(), size=size, levels=marked, level=0)[..., :3].max() == 8


def test_a_file_is_drawn_like_the_table_it_came_from(renderer: Renderer, tmp_path: Path) -> None:
    amc, mesh, view = brushed_amc(32, 30), MESHES["cloth"], View(pitch_deg=25)
    write_amc(tmp_path / "x.amc.ktx2", amc, half_float=True)
    read, levels = read_levels(tmp_path / "x.amc.ktx2")
    drawn = amc_picture(renderer, read, mesh, view, size=SIZE, levels=levels)
    np.testing.assert_array_equal(drawn, amc_picture(renderer, amc, mesh, view, size=SIZE))


def test_light_beyond_white_survives(renderer: Renderer) -> None:
    amc = brushed_amc(16, 8)
    bright = Amc(amc.slices * 50, amc.valid, amc.invariance)
    pictures = [amc_picture(renderer, table, torus(24, 12), View(), size=SIZE) for table in (amc, bright)]
    np.testing.assert_allclose(pictures[1][..., :3], pictures[0][..., :3] * 50, rtol=2e-2, atol=1e-2)
    assert pictures[1].max() > 5


@pytest.mark.parametrize("name", ["torus", "cloth"])
def test_supersampling_is_the_mean_of_a_finer_picture(renderer: Renderer, name: str) -> None:
    amc, mesh, view = brushed_amc(16, 8), builtin_mesh(name), View(pitch_deg=30)
    fine = amc_picture(renderer, amc, mesh, view, size=(120, 90)).astype(np.float64)
    smooth = amc_picture(renderer, amc, mesh, view, size=(40, 30), supersample=3)
    blocks = fine.reshape(30, 3, 40, 3, 4)
    coverage = blocks[..., 3].mean(axis=(1, 3))
    light = (blocks[..., :3] * blocks[..., 3:]).mean(axis=(1, 3))
    np.testing.assert_allclose(smooth[..., 3], coverage, atol=1e-6)
    np.testing.assert_allclose(smooth[..., :3] * smooth[..., 3:], light, atol=1e-5)
    assert np.any((coverage > 0) & (coverage < 1))


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        pytest.param({"level": 9}, "mip levels 0 to 4, not 9", id="a level that is not there"),
        pytest.param({"level": -1}, "not -1", id="a level below the first"),
        pytest.param({"supersample": 0}, "supersampling 0", id="no sample at all"),
        pytest.param({"size": (0, 10)}, "0 × 10 pixels", id="no pixels"),
        pytest.param({"size": (10**6, 10)}, "1000000 × 10 pixels", id="more pixels than the driver draws"),
    ],
)
def test_impossible_wishes_are_refused(renderer: Renderer, options: dict[str, object], reason: str) -> None:
    wishes = {"size": (32, 32), **options}
    with pytest.raises(InputError, match=reason):
        amc_picture(renderer, brushed_amc(16, 8), torus(12, 8), View(), **wishes)  # type: ignore[arg-type] # by table
