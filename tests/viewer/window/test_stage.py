"""What the window shows, drawn without one: against the renderer's pictures, NumPy, and `litrig render`."""

import dataclasses
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from litrig.base.errors import InputError
from litrig.base.pictures import read_linear
from litrig.base.radiometry import to_u8
from processing.amc.files.ktx2 import write_amc
from processing.matcap.matcap_exr import write_matcap
from processing.mesh.builtin import torus
from processing.mesh.either import mesh_of
from processing.ptm.basis import Basis
from processing.ptm.files.ptm_exr import write_ptm_exr
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.relighting.relight import relight
from tests.processing.matcap.maps import analytic
from tests.viewer.analytic import brushed_amc
from tests.viewer.window.materials import DISPLAY_STEPS, Codes, shown_codes, soft_ptm
from viewer.cli import render
from viewer.geometry import mesh_geometry
from viewer.materials.amc import amc_picture
from viewer.materials.decomposed_matcap import DecomposedMatcapMaterial
from viewer.opened_matcap import towards
from viewer.renderer import Renderer
from viewer.view import Projection
from viewer.window.display import DisplayTarget
from viewer.window.material import read_material
from viewer.window.saving import render_command, saving_beside
from viewer.window.stage import MOST_PIXELS, Stage, affordable
from viewer.window.state import Shown
from viewer.window.turn import of_angles

SIZE = (90, 70)
HSH = Basis("hsh", 4)
TURNED = of_angles(20, 35, 50)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("materials")
    write_amc(folder / "brushed.amc.ktx2", brushed_amc(16, 8))
    write_ptm(folder / "soft.ptm", soft_ptm(*SIZE))
    write_ptm_exr(folder / "linear.ptm.exr", dataclasses.replace(soft_ptm(*SIZE), space="linear"))
    write_matcap(folder / "gold.matcap.exr", analytic(32))
    soft = soft_ptm(*SIZE)
    write_ptm_exr(
        folder / "harmonics.ptm.exr", dataclasses.replace(soft, coefficients=soft.coefficients[2:], basis=HSH)
    )
    return folder


@contextmanager
def stage_for(renderer: Renderer, file: Path) -> Iterator[Stage]:
    with Stage(renderer, read_material(file)) as stage:
        yield stage


def codes(renderer: Renderer, display: DisplayTarget) -> Codes:
    """Read what imgui is handed."""
    with renderer._gl.moderngl:
        raw = display.colour.read()
    return np.frombuffer(raw, np.uint8).reshape(display.size[1], display.size[0], 4)[::-1, :, :3]


@pytest.mark.parametrize("projection", Projection)
def test_an_amc_is_shown_as_the_renderer_draws_it(renderer: Renderer, files: Path, projection: Projection) -> None:
    shown = Shown("sphere", turn=TURNED, projection=projection, zoom=1.4)
    with stage_for(renderer, files / "brushed.amc.ktx2") as stage:
        seen = codes(renderer, stage.show(shown, SIZE, moving=False))
    mesh, _ = mesh_of("sphere")
    drawn = amc_picture(renderer, brushed_amc(16, 8), mesh, shown.view, size=SIZE, supersample=3)
    assert np.abs(seen.astype(int) - shown_codes(drawn)).max() <= 1 + DISPLAY_STEPS  # the file holds half floats
    assert seen.std() > 15


def test_edges_are_smooth_at_rest_and_quick_in_motion(renderer: Renderer, files: Path) -> None:
    shown = Shown("torus", turn=TURNED)
    with stage_for(renderer, files / "brushed.amc.ktx2") as stage:
        rough = codes(renderer, stage.show(shown, SIZE, moving=True))
        fine = codes(renderer, stage.show(shown, SIZE, moving=False))
    apart = np.abs(rough.astype(int) - fine).max(axis=-1)
    assert apart.max() > 20 and np.mean(apart > 20) < 0.1, "they differ at edges"


@pytest.mark.parametrize("name", ["soft.ptm", "linear.ptm.exr"])
def test_a_flat_ptm_is_shown_as_its_values_texel_by_texel(renderer: Renderer, files: Path, name: str) -> None:
    with stage_for(renderer, files / name) as stage:
        seen = codes(renderer, stage.show(Shown(None, light=(0.3, -0.5)), SIZE, moving=False))
    truth = to_u8(relight(read_ptm(files / "soft.ptm"), np.array([0.3, -0.5])))
    assert np.abs(seen.astype(int) - truth).max() <= DISPLAY_STEPS
    assert seen.std() > 15


def test_a_flat_ptm_is_zoomed_and_moved(renderer: Renderer, files: Path) -> None:
    """Twice as large, and its middle 7 pixels to the right and 14 up."""
    width, height = SIZE
    pan = (0.2, 0.4)  # in halves of the height
    with stage_for(renderer, files / "soft.ptm") as stage:
        plain = codes(renderer, stage.show(Shown(None, light=(0, 0)), SIZE, moving=False))
        zoomed = codes(renderer, stage.show(Shown(None, light=(0, 0), zoom=2.0, pan=pan), SIZE, moving=False))
    for x, y in ((40, 45), (50, 40), (45, 50)):
        column = round((x + 0.5 - width / 2) * 2 + width / 2 + 7 - 0.5)
        row = round((y + 0.5 - height / 2) * 2 + height / 2 - 14 - 0.5)
        np.testing.assert_allclose(zoomed[row, column].astype(int), plain[y, x], atol=4)
    assert plain.std(axis=(0, 1)).max() > 8, "there is something to tell places by"


def test_the_light_of_a_decomposed_matcap_turns_from_where_it_stands(renderer: Renderer, files: Path) -> None:
    assert read_material(files / "gold.matcap.exr").light == pytest.approx((0, 0))
    view = Shown("torus", (0, 0), TURNED).view
    with stage_for(renderer, files / "gold.matcap.exr") as stage:
        still, turned = (
            codes(renderer, stage.show(Shown("torus", light, TURNED), SIZE, moving=True))
            for light in ((0, 0), (0.5, 0.4))
        )
    with (
        renderer.upload(DecomposedMatcapMaterial, analytic(32)) as gold,
        renderer.upload(mesh_geometry, torus()) as geometry,
    ):
        for seen, turn in ((still, Rotation.identity()), (turned, towards((0.5, 0.4)))):
            wanted = shown_codes(renderer.picture(gold.look(light_turn=turn), geometry, view, size=SIZE))
            assert np.abs(seen.astype(int) - wanted).max() <= DISPLAY_STEPS
    assert np.abs(still.astype(int) - turned).max() > 60


def test_nothing_is_drawn_twice(renderer: Renderer, files: Path) -> None:
    with stage_for(renderer, files / "soft.ptm") as stage:
        for moving in (False, False, True, False):
            stage.show(Shown("torus", light=(0, 0)), SIZE, moving=moving)
        assert stage.pictures_drawn == 1, "a fine picture serves in motion too"
        stage.show(Shown("torus", light=(0.1, 0)), SIZE, moving=True)
        stage.show(Shown("torus", light=(0.1, 0)), SIZE, moving=False)
        stage.show(Shown("torus", light=(0.1, 0)), (50, 40), moving=False)
        stage.show(Shown("sphere", light=(0.1, 0)), (50, 40), moving=False)
        assert stage.pictures_drawn == 5


@pytest.mark.parametrize("ending", [".png", ".exr"])
@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("brushed.amc.ktx2", Shown("sewn", turn=TURNED, zoom=1.3)),
        ("soft.ptm", Shown("torus", (0.2, 0.6), TURNED, Projection.ORTHOGRAPHIC)),
        ("soft.ptm", Shown(None, (0.2, 0.6))),
        ("linear.ptm.exr", Shown(None, (0.2, 0.6))),
        ("harmonics.ptm.exr", Shown("pillow", (0.2, 0.6))),
        ("gold.matcap.exr", Shown("torus", (0.4, -0.3), TURNED)),
    ],
    ids=["an AMC", "a PTM on a mesh", "a flat PTM", "a flat linear PTM", "an HSH on a mesh", "a decomposed MatCap"],
)
def test_a_snapshot_is_the_file_that_its_command_writes(
    renderer: Renderer, files: Path, tmp_path: Path, name: str, shown: Shown, ending: str
) -> None:
    with stage_for(renderer, files / name) as stage:
        stage.save(shown, (61, 47), tmp_path / f"snapshot{ending}")
    words = render_command(files / name, shown, (61, 47), tmp_path / f"rendered{ending}")
    assert words[:2] == ["litrig", "render"]
    CliRunner().invoke(render, words[2:], standalone_mode=False, catch_exceptions=False)
    assert (tmp_path / f"snapshot{ending}").read_bytes() == (tmp_path / f"rendered{ending}").read_bytes()
    assert read_linear(tmp_path / f"snapshot{ending}").shape[:2] == ((47, 61) if shown.mesh else SIZE[::-1])


def test_a_snapshot_that_cannot_be_written_leaves_the_stage_as_it_was(
    renderer: Renderer, files: Path, tmp_path: Path
) -> None:
    shown = Shown("torus", light=(0, 0))
    with stage_for(renderer, files / "soft.ptm") as stage:
        before = codes(renderer, stage.show(shown, SIZE, moving=False))
        with pytest.raises((InputError, OSError)):
            stage.save(shown, SIZE, tmp_path / "nowhere" / "x.png")
        np.testing.assert_array_equal(codes(renderer, stage.show(shown, SIZE, moving=False)), before)
        assert list(tmp_path.iterdir()) == []


def test_snapshots_take_no_name_that_is_taken(tmp_path: Path) -> None:
    saving = saving_beside(tmp_path, Path("some/steel.amc.ktx2"))
    for name in ("steel.png", "steel-2.png", "steel-3.png"):
        assert saving.free_name(".png") == tmp_path / name
        (tmp_path / name).touch()
    assert saving.free_name(".exr") == tmp_path / "steel.exr"


def test_large_windows_are_drawn_less_finely() -> None:
    assert affordable((800, 700), 3) == 3
    assert affordable((3840, 2160), 3) == 1
    assert affordable((1920, 1080), 3) ** 2 * 1920 * 1080 <= MOST_PIXELS


def test_a_missing_file_and_a_mesh_that_is_none_are_refused(renderer: Renderer, files: Path) -> None:
    with pytest.raises(InputError, match="nowhere"):
        read_material(files / "nowhere.amc.ktx2")
    with stage_for(renderer, files / "brushed.amc.ktx2") as stage:
        with pytest.raises(InputError, match="no such mesh"):
            stage.show(Shown("teapot"), SIZE, moving=False)
        with pytest.raises(InputError, match="no flat picture"):
            stage.show(Shown(None), SIZE, moving=False)
        stage.show(Shown("torus"), SIZE, moving=False)
        assert stage.pictures_drawn == 1
