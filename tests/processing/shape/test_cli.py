"""Shape edited from the command line."""

import json
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from click.testing import CliRunner

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear, write_codes
from litrig.base.radiometry import encode_srgb, to_u8
from processing.reference.recompose import recompose as reference
from processing.shape.cli import shape
from processing.shape.env_exr import write_environments
from tests.processing.shape.scene import buffers, bumped, environments
from tests.processing.shape.stored import layers, write

BUFFERS, LIGHT = buffers(), environments(32)
BUMPED = bumped(BUFFERS.normals)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("shape")
    write(folder / "s.exr", layers(BUFFERS))
    for number in (8, 9):
        write(folder / f"f.{number:02d}.exr", layers(BUFFERS))
    write(folder / "n.exr", {name: BUMPED[..., index] for index, name in enumerate("XYZ")})
    write_environments(folder / "s.env.exr", LIGHT)
    return folder


def run(*words: str | Path | float) -> str:
    return CliRunner().invoke(shape, list(map(str, words)), standalone_mode=False, catch_exceptions=False).output


def recompose(files: Path, output: Path, *words: str | Path | float) -> str:
    return run("recompose", files / "s.exr", files / "s.env.exr", "-o", output, *words)


def test_no_edit_gives_the_picture_back_bit_for_bit(files: Path, tmp_path: Path) -> None:
    picture = BUFFERS.picture.copy()
    picture[60, 50] = -0.0, 1e-42, 1e4
    stored = {**layers(BUFFERS), **{name: picture[..., index] for index, name in enumerate("RGB")}}
    write(tmp_path / "s.exr", stored)
    told = run("recompose", tmp_path / "s.exr", files / "s.env.exr", "-o", tmp_path / "x.exr")
    assert told.endswith("150 × 120 pixels, 0.0% of them changed\n")
    with OpenEXR.File(str(tmp_path / "x.exr"), separate_channels=True) as exr:
        assert sorted(exr.channels()) == ["B", "G", "R"]
        for index, name in enumerate("RGB"):
            kept = exr.channels()[name].pixels
            assert kept.dtype == np.float32
            np.testing.assert_array_equal(kept.view(np.uint32), picture[..., index].view(np.uint32))


def test_an_exr_has_linear_light_and_a_png_display_values(files: Path, tmp_path: Path) -> None:
    said = ("--normals", files / "n.exr", "--kd", 0.5, "--kr", 2)
    for name in ("x.exr", "x.png"):
        recompose(files, tmp_path / name, *said)
    truth = reference(BUFFERS, LIGHT, BUMPED, diffuse_factor=0.5, reflection_factor=2)
    np.testing.assert_allclose(read_linear(tmp_path / "x.exr"), truth, atol=2e-5)
    assert np.abs(read_codes(tmp_path / "x.png").astype(int) - to_u8(encode_srgb(truth))).max() <= 1


def test_a_saved_recipe_does_what_the_options_did(files: Path, tmp_path: Path) -> None:
    write_codes(tmp_path / "h.png", np.random.default_rng(0).integers(0, 255, (20, 20, 3)).astype(np.uint8))
    write_codes(tmp_path / "m.png", np.repeat(np.full((120, 150, 1), 128, np.uint8), 3, axis=-1))
    words = ("--emboss", 0.6, "--smooth", 1.5, "--noise", 1, 12, "--seed", 3, "--ripple", 60, 50, 2, 15)
    bump = ("--bump", tmp_path / "h.png", "--bump-at", 40, 50, "--bump-size", 40, "--bump-height", 3, "--bump-turn", 20)
    where = ("--mask", tmp_path / "m.png", "--surface", 2, "--strength", 0.8, "--kr", 1.5)
    recipe = tmp_path / "r.recipe.toml"
    recompose(
        files, tmp_path / "a.exr", *words, *bump, *where, "--save-recipe", recipe, "--normals-out", tmp_path / "n.exr"
    )
    recompose(files, tmp_path / "b.exr", "--recipe", recipe)
    a, b = (read_linear(tmp_path / name) for name in ("a.exr", "b.exr"))
    np.testing.assert_array_equal(a, b)
    other = BUFFERS.surfaces != 2
    np.testing.assert_array_equal(a[other], BUFFERS.picture[other])
    assert np.abs(a - BUFFERS.picture).max() > 0.1
    recompose(files, tmp_path / "c.exr", "--normals", tmp_path / "n.exr")
    assert np.abs(read_linear(tmp_path / "c.exr") - BUFFERS.picture).max() > 0.1


def test_frames_of_a_sequence_share_their_environments(files: Path, tmp_path: Path) -> None:
    told = run("recompose", files / "f.##.exr", files / "s.env.exr", "--emboss", 0.5, "-o", tmp_path / "o.##.exr")
    lines = told.splitlines()
    written = [line for line in lines if not line.startswith("recompose: ")]
    assert [Path(line.split(":")[0]).name for line in written] == ["o.08.exr", "o.09.exr"]
    assert "recompose: 2/2  o.09.exr" in lines
    recompose(files, tmp_path / "one.exr", "--emboss", 0.5)
    np.testing.assert_array_equal(read_linear(tmp_path / "o.09.exr"), read_linear(tmp_path / "one.exr"))


def test_a_frame_without_surfaces_comes_through_and_surfaces_of_no_frame_are_named(files: Path, tmp_path: Path) -> None:
    write(tmp_path / "f.1.exr", layers(BUFFERS))
    write(tmp_path / "f.2.exr", {**layers(BUFFERS), "surface_id.I": np.zeros_like(BUFFERS.surfaces)})
    words: list[str | Path | float] = [
        tmp_path / "f.#.exr",
        files / "s.env.exr",
        "--emboss",
        0.5,
        "--surface",
        7,
        "--surface",
        8,
    ]
    told = run("recompose", *words, "-o", tmp_path / "o.#.exr")
    assert "no frame shows surface 8" in told and "surface 7," not in told
    assert np.any(read_linear(tmp_path / "o.1.exr") != BUFFERS.picture)
    np.testing.assert_array_equal(read_linear(tmp_path / "o.2.exr"), BUFFERS.picture)


def test_an_error_in_a_frame_names_it(files: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"f\.08\.exr: a place at 900, 5 is outside"):
        run("recompose", files / "f.##.exr", files / "s.env.exr", "--ripple", 900, 5, 1, 9, "-o", tmp_path / "o.##.exr")


def test_info_tells_what_is_there_and_what_is_not(files: Path, tmp_path: Path) -> None:
    stored = {
        name.replace("diffuse.", "light."): plane for name, plane in layers(BUFFERS).items() if "position" not in name
    }
    write(tmp_path / "x.exr", stored)
    facts = json.loads(run("info", tmp_path / "x.exr", "--json"))
    assert facts["size"] == "150 × 120" and facts["reflection"] == "reflection (litrig)"
    assert facts["missing"].startswith("diffuse, position, depth") and facts["other layers"] == "light"
    assert any("lacks diffuse.R" in str(value) for key, value in facts.items() if key.startswith("note"))
    told = run("info", tmp_path / "x.exr", "--layer", "diffuse=light")
    assert "surface 2: 7280 pixels" in told and "diffuse: light (--layer)" in told and "one direction" in told


def test_remarks_are_said_beside_the_result(files: Path, tmp_path: Path) -> None:
    write(tmp_path / "x.exr", {name: plane for name, plane in layers(BUFFERS).items() if "occlusion" not in name})
    told = CliRunner().invoke(
        shape, ["recompose", str(tmp_path / "x.exr"), str(files / "s.env.exr"), "-o", str(tmp_path / "o.exr")]
    )
    assert "note: no ambient occlusion" in told.stderr and "note" not in told.stdout


def test_pixels_that_are_no_numbers_come_through_an_exr_and_are_black_in_a_png(files: Path, tmp_path: Path) -> None:
    stored = layers(BUFFERS)
    stored["G"] = stored["G"].copy()
    stored["G"][60, 50] = np.nan
    write(tmp_path / "s.exr", stored)
    words: list[str | Path | float] = ["recompose", tmp_path / "s.exr", files / "s.env.exr", "--emboss", 0.5, "-o"]
    told = CliRunner().invoke(shape, list(map(str, [*words, tmp_path / "o.png"])), catch_exceptions=False)
    assert "1 pixels hold no numbers, and are black in o.png" in told.stderr
    assert read_codes(tmp_path / "o.png")[60, 50, 1] == 0
    run(*words, tmp_path / "o.exr")
    with OpenEXR.File(str(tmp_path / "o.exr"), separate_channels=True) as exr:
        assert np.isnan(exr.channels()["G"].pixels[60, 50])
        assert np.count_nonzero(~np.isfinite(exr.channels()["G"].pixels)) == 1


def test_a_surface_without_an_environment_is_named(files: Path, tmp_path: Path) -> None:
    write_environments(tmp_path / "one.env.exr", {7: LIGHT[7]})
    words = ["recompose", files / "s.exr", tmp_path / "one.env.exr", "--emboss", 0.5, "-o", tmp_path / "o.exr"]
    told = CliRunner().invoke(shape, list(map(str, words)))
    assert "no environment of surface 2, which stays" in told.stderr
    made, other = read_linear(tmp_path / "o.exr"), BUFFERS.surfaces != 7
    np.testing.assert_array_equal(made[other], BUFFERS.picture[other])


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--surface", "3", "--emboss", "0.5"], "no surface 3 in the picture; there are 2, 7"),
        (["--recipe", "no.recipe.toml"], "(?i)no such file"),
        (["--normals", "s.env.exr"], "no normals|pixels"),
        (["--layer", "diffuse=shine"], "has no layers shine"),
        (["--layer", "shine"], "write BUFFER=LAYER"),
        (["-o", "o.##.exr"], "in neither"),
        (["-o", "o.gif"], "cannot be written as .gif"),
        (["-o", "s.exr"], "s.exr: is read"),
        (["-o", "./s.env.exr"], "s.env.exr: is read"),
        (["--normals", "n.exr", "--normals-out", "n.exr"], "n.exr: is read"),
        (["--normals-out", "x.exr", "-o", "x.exr"], "to be written twice"),
        (["--fov", "200"], "needs no field|0 and 180"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_does_not_go_together_is_one_clear_error(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], reason: str
) -> None:
    if "--fov" in words:
        stored = {name: plane for name, plane in layers(BUFFERS).items() if "position" not in name}
        write(tmp_path / "s.exr", {**stored, "depth.Z": np.ones(BUFFERS.shape, np.float32)})
    else:
        write(tmp_path / "s.exr", layers(BUFFERS))
    write_environments(tmp_path / "s.env.exr", LIGHT)
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    out = [] if "-o" in words else ["-o", "o.png"]
    with pytest.raises(InputError, match=reason) as caught:
        run("recompose", "s.exr", "s.env.exr", *words, *out)
    assert "\n" not in str(caught.value)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--fade", "3"], "--fade is said of --ripple"),
        (["--mask", "m.png"], "--mask is said of an edit"),
        (["--bump", "h.png", "--across", "positions"], "give --bump-size"),
        (["--noise", "1", "5", "--displace"], "give --across positions"),
        (["--emboss", "1.5"], "not in the range"),
        (["--noise", "nan", "5"], "not a finite number"),
    ],
)
def test_wrong_usage_is_told_by_the_parser(words: list[str], reason: str) -> None:
    told = CliRunner().invoke(shape, ["recompose", "s.exr", "s.env.exr", "-o", "o.png", *words])
    assert told.exit_code == 2 and reason in told.output
