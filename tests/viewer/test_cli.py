"""`litrig render`, as it is typed."""

import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from litrig.base.errors import InputError, LitrigError
from litrig.base.pictures import read_linear
from litrig.base.radiometry import to_u8
from processing.amc.files.ktx2 import read_amc, write_amc
from processing.amc.isotropic import isotropic_matcap
from processing.amc.model import Amc
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.model import Ptm
from processing.ptm.relighting.relight import relight
from tests.viewer.analytic import brushed_amc
from viewer.cli import render
from viewer.materials.ptm_shading import DEFAULT_LIGHT

SMALL = ["--size", "60", "40", "--supersample", "1"]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("materials")
    write_amc(folder / "brushed.amc.ktx2", brushed_amc(16, 8))
    write_amc(folder / "flat-levels.amc.ktx2", brushed_amc(16, 8), mip_levels=False)
    random = np.random.default_rng(2)
    coefficients = random.uniform(-0.3, 0.3, (6, 9, 14, 1)).astype(np.float32)
    coefficients[5] += 0.5
    write_ptm(folder / "coin.ptm", Ptm(coefficients, random.uniform(0.3, 1, (9, 14, 3)).astype(np.float32)))
    return folder


def run(*arguments: str | Path | float) -> str:
    """Run the command as the front door does: errors of litrig come through."""
    words = [str(argument) for argument in arguments]
    return CliRunner().invoke(render, words, standalone_mode=False, catch_exceptions=False).output


def codes(path: Path) -> NDArray[np.uint8]:
    picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert picture is not None and picture.dtype == np.uint8
    order = cv2.COLOR_BGRA2RGBA if picture.shape[-1] == 4 else cv2.COLOR_BGR2RGB
    return np.asarray(cv2.cvtColor(picture, order), np.uint8)


@pytest.mark.parametrize("mesh", ["torus", "sphere", "cloth", "ribbon", "pillow", "sewn", "shirt"])
def test_an_amc_is_drawn_on_every_mesh(files: Path, tmp_path: Path, mesh: str) -> None:
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "x.png", "--mesh", mesh, *SMALL)
    picture = codes(tmp_path / "x.png")
    assert picture.shape == (40, 60, 3)
    assert tuple(picture[0, 0]) == (0x20, 0x21, 0x24), "the quiet background"
    assert np.any(picture != picture[0, 0])


def test_the_mesh_is_a_torus_if_none_is_named(files: Path, tmp_path: Path) -> None:
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "a.png", *SMALL)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "b.png", "--mesh", "torus", *SMALL)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_mesh_can_be_a_file_and_what_it_lacks_is_said(files: Path, tmp_path: Path) -> None:
    (tmp_path / "tent.obj").write_text("v -1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 4 3\nf 4 2 3\n")
    words = [files / "brushed.amc.ktx2", "-o", tmp_path / "x.png", "--mesh", tmp_path / "tent.obj", *SMALL]
    ran = CliRunner().invoke(render, [str(word) for word in words], standalone_mode=False, catch_exceptions=False)
    picture = codes(tmp_path / "x.png")
    assert np.any(picture != picture[0, 0])
    assert ran.stdout == f"{tmp_path / 'x.png'}: 60 × 40 pixels\n"
    assert [line.split("; ")[0] for line in ran.stderr.splitlines()] == [
        f"{tmp_path / 'tent.obj'}: has no normals",
        f"{tmp_path / 'tent.obj'}: has no texture coordinates",
    ]


def test_a_file_without_small_levels_gets_them(files: Path, tmp_path: Path) -> None:
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "a.png", *SMALL)
    run(files / "flat-levels.amc.ktx2", "-o", tmp_path / "b.png", *SMALL)
    np.testing.assert_allclose(codes(tmp_path / "a.png").astype(int), codes(tmp_path / "b.png"), atol=2)


@pytest.mark.parametrize(
    "option",
    [
        *(["--yaw", "40"], ["--pitch", "70"], ["--roll", "50"], ["--fov", "60"], ["--zoom", "1.5"]),
        ["--projection", "orthographic"],
    ],
    ids=" ".join,
)
def test_every_option_of_the_view_changes_the_picture(files: Path, tmp_path: Path, option: list[str]) -> None:
    cloth = ["--mesh", "cloth", *SMALL]  # a torus would not mind being turned
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "a.png", *cloth)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "b.png", *cloth, *option)
    assert np.abs(codes(tmp_path / "a.png").astype(int) - codes(tmp_path / "b.png")).max() > 20


def direction_map(path: Path, x: float, y: float) -> Path:
    """One direction all over."""
    blue_green_red = np.array([0, round(255 * (y + 1) / 2), round(255 * (x + 1) / 2)], np.uint8)
    cv2.imwrite(str(path), np.tile(blue_green_red, (3, 4, 1)))
    return path


def test_the_same_torus_with_its_grain_turned_is_another_picture(files: Path, tmp_path: Path) -> None:
    """And half a turn is none for a material with R = 2."""
    for turn_deg in (0, 90, 180):
        run(files / "brushed.amc.ktx2", "-o", tmp_path / f"{turn_deg}.png", "--turn", turn_deg, *SMALL)
    straight, across, back = (codes(tmp_path / f"{turn_deg}.png").astype(int) for turn_deg in (0, 90, 180))
    assert np.abs(across - straight).max() > 50
    np.testing.assert_allclose(back, straight, atol=1)


def test_directions_can_be_painted_and_then_turned(files: Path, tmp_path: Path) -> None:
    up = direction_map(tmp_path / "up.png", 0, 1)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "a.png", "--directions", up, *SMALL)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "b.png", "--turn", 90, *SMALL)
    np.testing.assert_allclose(codes(tmp_path / "a.png").astype(int), codes(tmp_path / "b.png"), atol=2)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "c.png", "--directions", up, "--turn", -90, *SMALL)
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "d.png", *SMALL)
    np.testing.assert_allclose(codes(tmp_path / "c.png").astype(int), codes(tmp_path / "d.png"), atol=2)


def test_a_map_that_names_no_direction_is_refused_with_its_name(files: Path, tmp_path: Path) -> None:
    grey = direction_map(tmp_path / "grey.png", 0, 0)
    with pytest.raises(InputError, match=r"grey\.png: names no direction at (\d+) of \1 vertices; paint"):
        run(files / "brushed.amc.ktx2", "-o", tmp_path / "x.png", "--directions", grey, *SMALL)
    assert not (tmp_path / "x.png").exists()


def test_the_light_breaks_at_a_seam_of_an_amc_and_not_of_its_isotropic_matcap(files: Path, tmp_path: Path) -> None:
    """The AMC paper's figure 11."""
    amc = read_amc(files / "brushed.amc.ktx2")
    write_amc(tmp_path / "isotropic.amc.ktx2", Amc(isotropic_matcap(amc)[None], amc.valid[:1], "isotropic"))
    jumps = []
    for file in (files / "brushed.amc.ktx2", tmp_path / "isotropic.amc.ktx2"):
        run(
            file,
            "-o",
            tmp_path / "x.png",
            "--mesh",
            "sewn",
            "--pitch",
            20,
            "--size",
            240,
            240,
            "--background",
            "#000000",
        )
        # Down the middle of the front, over the seam between yoke and panel.
        line = codes(tmp_path / "x.png")[95:118, 105:140].astype(int)
        jumps.append(np.abs(np.diff(line, axis=0)).max(axis=0).mean())
    assert jumps[0] > 3 * jumps[1]


def test_a_transparent_background_is_alpha(files: Path, tmp_path: Path) -> None:
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "x.png", "--background", "transparent", *SMALL)
    assert set(np.unique(codes(tmp_path / "x.png")[..., 3])) == {0, 255}


def test_edges_blend_in_light_with_a_coloured_background(files: Path, tmp_path: Path) -> None:
    run(files / "brushed.amc.ktx2", "-o", tmp_path / "x.exr", "--background", "#ffffff", *SMALL)
    assert read_linear(tmp_path / "x.exr")[0, 0] == pytest.approx([1, 1, 1])


@pytest.mark.parametrize(
    ("arguments", "size"),
    [
        pytest.param(["brushed.amc.ktx2", *SMALL], "60 × 40", id="AMC"),
        pytest.param(["coin.ptm"], "14 × 9", id="flat PTM"),
        pytest.param(["coin.ptm", "--mesh", "pillow", *SMALL], "60 × 40", id="PTM on a mesh"),
    ],
)
def test_what_was_written_is_said(files: Path, tmp_path: Path, arguments: list[str], size: str) -> None:
    out = tmp_path / "x.png"
    assert run(files / arguments[0], "-o", out, *arguments[1:]) == f"{out}: {size} pixels\n"


@pytest.mark.parametrize("light", [(0.3, 0.2), (-0.7, 0.5)], ids=str)
def test_a_flat_ptm_has_its_own_size_and_its_values_as_codes(
    files: Path, tmp_path: Path, light: tuple[float, float]
) -> None:
    run(files / "coin.ptm", "-o", tmp_path / "x.png", "--light", str(light[0]), str(light[1]))
    values = relight(read_ptm(files / "coin.ptm"), np.array(light))
    np.testing.assert_allclose(codes(tmp_path / "x.png").astype(int), to_u8(values), atol=1)
    assert np.mean(codes(tmp_path / "x.png") != to_u8(values)) < 0.01


def test_a_ptm_can_be_laid_on_a_mesh(files: Path, tmp_path: Path) -> None:
    run(files / "coin.ptm", "-o", tmp_path / "x.jpg", "--mesh", "pillow", "--light", "0.2", "0.3", *SMALL)
    assert codes(tmp_path / "x.jpg").shape == (40, 60, 3)


@pytest.mark.parametrize("options", [("--specular", "0.5", "20"), ("--repeat", "3")], ids=" ".join)
def test_a_highlight_and_repeating_change_the_picture(files: Path, tmp_path: Path, options: tuple[str, ...]) -> None:
    for name, more in (("plain", ()), ("other", options)):
        run(files / "coin.ptm", "-o", tmp_path / f"{name}.png", "--mesh", "torus", *SMALL, *more)
    assert np.mean(codes(tmp_path / "plain.png") != codes(tmp_path / "other.png")) > 0.05


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        pytest.param(["no.amc.ktx2", "-o", "x.png"], "(?i)no such file", id="missing file"),
        pytest.param(["no.ptm", "-o", "x.png"], "(?i)no such file", id="missing PTM"),
        pytest.param(["coin.tga", "-o", "x.png"], "unknown ending; give", id="unknown ending"),
        pytest.param(["brushed.amc.ktx2", "-o", "x.gif"], "cannot write .gif", id="unknown picture format"),
        pytest.param(["brushed.amc.ktx2", "-o", "x.png", "--mesh", "teapot"], "use one of torus", id="unknown mesh"),
        pytest.param(["brushed.amc.ktx2", "-o", "x.png", "--mesh", "a.obj"], r"a\.obj: no such file", id="mesh file"),
        pytest.param(["coin.ptm", "-o", "x.png", "--mesh", "teapot"], "use one of torus", id="unknown mesh for a PTM"),
        pytest.param(["brushed.amc.ktx2", "-o", "x.png", "--light", "0", "0"], "was lit when", id="a light for an AMC"),
        pytest.param(["coin.ptm", "-o", "x.png", "--light", "0.9", "0.9"], "is no direction", id="a light below"),
        pytest.param(["coin.ptm", "-o", "x.png", "--size", "9", "9"], "has its own size", id="a size for a flat PTM"),
        pytest.param(
            ["coin.ptm", "-o", "x.png", "--yaw", "0"], "--yaw would not change a flat", id="a turn of a flat PTM"
        ),
        pytest.param(["coin.ptm", "-o", "x.png", "--repeat", "2"], "--repeat would not", id="a flat PTM repeated"),
        pytest.param(
            ["brushed.amc.ktx2", "-o", "x.png", "--specular", "1", "9"], "what is for PTMs", id="gloss for an AMC"
        ),
        pytest.param(["coin.ptm", "-o", "x.png", "--turn", "90"], "has no grain to turn", id="a turned flat PTM"),
        pytest.param(
            ["coin.ptm", "-o", "x.png", "--mesh", "torus", "--turn", "90"], "has no grain to turn", id="a turned PTM"
        ),
        pytest.param(
            ["coin.ptm", "-o", "x.png", "--directions", "map.png"], "or to paint; leave out", id="a painted flat PTM"
        ),
        pytest.param(
            ["brushed.amc.ktx2", "-o", "x.png", "--directions", "no.png"], r"no\.png: no such", id="missing directions"
        ),
        pytest.param(
            ["brushed.amc.ktx2", "-o", "x.png", "--directions", "x.jpg"], "use PNG or EXR", id="directions as JPEG"
        ),
        pytest.param(["brushed.amc.ktx2", "-o", "x.png", "--turn", "nan"], "cannot be turned by nan", id="turn by nan"),
        pytest.param(["coin.ptm", "-o", f"{'x' * 300}.png"], "File name too long", id="a name too long"),
        pytest.param(["brushed.amc.ktx2", "-o", "x.png", "--fov", "170"], "outside 1..120", id="a field of view"),
        pytest.param(
            ["brushed.amc.ktx2", "-o", "x.jpg", "--background", "transparent"], "cannot be transparent", id="clear JPEG"
        ),
        pytest.param(["brushed.amc.ktx2", "-o", "nowhere/x.png"], "does not exist; create it", id="missing folder"),
    ],
)
def test_what_cannot_be_is_one_clear_error(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], reason: str
) -> None:
    for file in files.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(InputError, match=reason) as caught:
        run(*arguments)
    assert isinstance(caught.value, LitrigError) and "\n" not in str(caught.value)
    assert sorted(tmp_path.iterdir()) == before, "nothing is left behind"


@pytest.mark.parametrize(
    "arguments",
    [["x.ptm"], ["x.ptm", "-o", "x.png", "--size", "0", "4"], ["x.ptm", "-o", "x.png", "--background", "red"]],
    ids=" ".join,
)
def test_wrong_usage_is_the_parsers_affair(arguments: list[str]) -> None:
    assert CliRunner().invoke(render, arguments).exit_code == 2


def test_the_light_in_the_help_is_the_one_that_is_taken() -> None:
    words = " ".join(f"{part:g}" for part in DEFAULT_LIGHT)
    assert f"{words} if left out" in " ".join(CliRunner().invoke(render, ["--help"]).output.split())


def test_the_help_has_an_example() -> None:
    answer = CliRunner().invoke(render, ["--help"])
    assert answer.exit_code == 0
    assert "Example: litrig render" in answer.output


def test_asking_for_help_opens_no_graphics() -> None:
    script = "import sys, viewer.cli; print([m for m in ('numpy', 'moderngl', 'cv2', 'pydantic') if m in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"
