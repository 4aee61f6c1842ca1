"""The commands end to end; what they compute is tested beside the modules that compute it."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear, write_codes, write_picture
from processing.amc.cli import amc
from processing.amc.files.ktx2 import read_amc
from processing.ptm.cli import ptm
from processing.ptm.files.ptm_file import read_ptm
from tests.base.test_pictures import write_dng
from tests.processing.amc.brushed_sphere import Scene, true_table
from tests.processing.ptm.relief import dome, write_relief


@pytest.fixture(scope="module")
def sphere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = Scene(circle=(59.3, 54.8, 46.4), shape=(110, 118), samples=2)
    return scene.shoot(tmp_path_factory.mktemp("sphere"), np.linspace(0, 337.5, 16))


@pytest.fixture(scope="module")
def relief(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("relief")
    write_relief(folder, dome(12), 24)
    return folder


def run(group: object, *arguments: object) -> Result:
    """Run a command; what it raises is raised here."""
    return CliRunner().invoke(group, [str(word) for word in arguments], catch_exceptions=False)  # type: ignore[arg-type]


def test_build_writes_the_table_and_says_what_it_found(sphere: Path, tmp_path: Path) -> None:
    out = tmp_path / "x.amc.ktx2"
    result = run(amc, "build", sphere, "-o", out, "--size", 24)
    assert result.exit_code == 0
    for words in (
        "centre 59.",
        "radius 46.",
        "orthographic",
        "R = 2\n",
        "the same in 100% of",
        "8 slices of 24 × 24",
        str(out),
    ):
        assert words in result.output
    assert read_amc(out).slices.shape == (8, 24, 24, 3)


def test_build_takes_every_option(sphere: Path, tmp_path: Path) -> None:
    out = tmp_path / "x.amc.ktx2"
    options = "--size 16 --depth 5 --invariance 1 --circle 59.3 54.8 46.4 --distance 8 --normal view --tangent-zero 40"
    result = run(amc, "build", sphere, "-o", out, *options.split(), "--threshold", 0.1)
    assert "camera at 8.00 radii" in result.output
    assert "R = 1, as asked for (found: 2)" in result.output
    table = read_amc(out)
    assert (len(table.slices), table.invariance, str(table.table_normal)) == (5, 1, "view")
    assert table.slice_angles_deg[0] == pytest.approx(40)


def test_build_takes_the_distance_from_a_camera_model(sphere: Path, tmp_path: Path) -> None:
    camera = tmp_path / "camera.toml"
    camera.write_text(
        "width = 118\nheight = 110\nfocal_x_px = 464\nfocal_y_px = 464\ncentre_x_px = 59.3\ncentre_y_px = 54.8\n"
    )
    result = run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 16, "--camera", camera)
    assert "camera at 10.0" in result.output


def test_build_says_which_frame_is_missing(sphere: Path, tmp_path: Path) -> None:
    folder = tmp_path / "gap"
    folder.mkdir()
    for picture in sphere.glob("*.png"):
        (folder / picture.name).write_bytes(picture.read_bytes())
    lines = (sphere / "angles.csv").read_text().splitlines()
    (folder / "angles.csv").write_text("\n".join(line for line in lines if not line.endswith(",90.000000")))
    said = run(amc, "build", folder, "-o", tmp_path / "x.amc.ktx2", "--size", 16).output
    assert "no frame between 67.5 and 112.5 deg" in said
    assert "no frame" not in run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 16).output


def test_build_says_which_pictures_no_angle_names(sphere: Path, tmp_path: Path) -> None:
    folder = tmp_path / "more"
    shutil.copytree(sphere, folder)
    for name in ("white.png", "before.png"):
        shutil.copy(folder / "frame_0000.png", folder / name)
    result = run(amc, "build", folder, "-o", tmp_path / "x.amc.ktx2", "--size", 16)
    assert f"{folder}: 2 pictures are not named in its list of angles, and left out: before.png" in result.output
    assert "left out" not in run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 16).output
    said = json.loads(run(amc, "build", folder, "-o", tmp_path / "x.amc.ktx2", "--size", 16, "--json").stdout)
    assert said["left_out"] == {str(folder): ["before.png", "white.png"]}


def test_build_speaks_json_and_writes_a_page(sphere: Path, tmp_path: Path) -> None:
    out, page = tmp_path / "x.amc.ktx2", tmp_path / "x.report"
    result = run(amc, "build", sphere, "-o", out, "--size", 24, "--json", "--report", page)
    (said,) = json.loads(result.stdout)["tables"]
    assert (said["file"], said["found"], said["depth"]) == (str(out), 2, 8)
    assert said["circle_px"] == pytest.approx([59.3, 54.8, 46.4], abs=0.3)
    assert len(said["residuals"]) == 16
    html = (page / "index.html").read_text()
    for picture in ("mean.png", "rotation.png", "residuals.png", "ranks.png"):
        assert picture in html
        assert read_codes(page / picture).std() > 1


def test_build_splits_diffuse_light_from_gloss(sphere: Path, tmp_path: Path) -> None:
    result = run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 24, "--split", "--distance", 8)
    assert result.exit_code == 0
    low, high = (read_amc(tmp_path / f"x.{name}.amc.ktx2") for name in ("low", "high"))
    assert (str(low.table_normal), str(high.table_normal)) == ("camera", "rectified")
    assert low.invariance == "isotropic"
    assert high.invariance == 2
    assert not (tmp_path / "x.amc.ktx2").exists()


def test_build_makes_a_companion_without_the_key_light(sphere: Path, tmp_path: Path) -> None:
    dark = Scene(circle=(59.3, 54.8, 46.4), shape=(110, 118), samples=2, lights=1)
    folder = dark.shoot(tmp_path / "dark", np.linspace(0, 337.5, 16))
    run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 24, "--unlit", folder)
    lit, unlit = (read_amc(tmp_path / name) for name in ("x.amc.ktx2", "x.unlit.amc.ktx2"))
    assert lit.slices.shape == unlit.slices.shape
    assert (lit.invariance, lit.tangent_angle) == (unlit.invariance, unlit.tangent_angle)
    assert unlit.slices.mean() < 0.8 * lit.slices.mean()


def test_build_spreads_pictures_without_angles_evenly(sphere: Path, tmp_path: Path) -> None:
    folder = tmp_path / "plain"
    folder.mkdir()
    for picture in sphere.glob("*.png"):
        (folder / picture.name).write_bytes(picture.read_bytes())
    with pytest.raises(InputError, match=r"frame_0000\.png: has no turntable angle.*--even"):
        run(amc, "build", folder, "-o", tmp_path / "x.amc.ktx2")
    run(amc, "build", folder, "-o", tmp_path / "x.amc.ktx2", "--even", "--size", 16)
    assert read_amc(tmp_path / "x.amc.ktx2").slice_angles_deg == pytest.approx(np.arange(16) * 22.5)
    with pytest.raises(InputError, match="leave --even out"):
        run(amc, "build", sphere, "-o", tmp_path / "y.amc.ktx2", "--even")


def test_pictures_under_many_lights_are_no_turn(relief: Path, tmp_path: Path) -> None:
    for options in ([], ["--even"]):
        with pytest.raises(InputError, match=r"under many lights.*litrig ptm fit"):
            run(amc, "build", relief, "-o", tmp_path / "x.amc.ktx2", *options)


def test_a_page_that_cannot_be_is_refused_before_the_work(sphere: Path, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match=r"taken: is a file"):
        run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--report", tmp_path / "taken")
    assert not (tmp_path / "x.amc.ktx2").exists()


def test_light_that_a_picture_cannot_hold_is_said(tmp_path: Path) -> None:
    scene = Scene("isotropic", (159.3, 134.8, 106.4), (270, 318))
    write_picture(tmp_path / "ball.exr", 4 * scene.picture(0).astype(np.float32))
    said = run(amc, "matcap", tmp_path / "ball.exr", "-o", tmp_path / "x.png", "--size", 64).output
    assert "brighter than white" in said


def test_build_takes_a_mask(sphere: Path, tmp_path: Path) -> None:
    mask = np.zeros((110, 118, 3), np.uint8)
    mask[40:50, 60:90] = 255
    write_codes(tmp_path / "mask.png", mask)
    out = tmp_path / "x.amc.ktx2"
    result = run(amc, "build", sphere, "-o", out, "--size", 24, "--mask", tmp_path / "mask.png", "--json")
    (said,) = json.loads(result.stdout)["tables"]
    assert 0.03 < said["filled"] < 0.15


def test_raw_pictures_make_the_same_table(tmp_path: Path) -> None:
    """A mosaic tells one colour a pixel, the others are guessed from its neighbours'."""
    scene = Scene(circle=(59.3, 54.8, 46.4), shape=(110, 118), samples=2)
    angles_deg = np.linspace(0, 330, 12)
    scene.shoot(tmp_path / "png", angles_deg)
    (tmp_path / "raw").mkdir()
    lines = ["name,deg"]
    for angle_deg in angles_deg:
        light = scene.picture(float(angle_deg))
        mosaic = light[..., 1].copy()
        mosaic[::2, ::2], mosaic[1::2, 1::2] = light[::2, ::2, 0], light[1::2, 1::2, 2]
        name = f"{angle_deg:03.0f}.dng"
        write_dng(tmp_path / "raw" / name, np.rint(512 + np.clip(mosaic, 0, 1) * (65535 - 512)).astype(np.uint16))
        lines.append(f"{name},{angle_deg}")
    (tmp_path / "raw" / "angles.csv").write_text("\n".join(lines))
    tables = []
    for kind in ("png", "raw"):
        run(amc, "build", tmp_path / kind, "-o", tmp_path / f"{kind}.amc.ktx2", "--size", 16, "--invariance", 1)
        tables.append(read_amc(tmp_path / f"{kind}.amc.ktx2").slices)
    assert tables[0].shape == (12, 16, 16, 3)
    assert np.sqrt(np.mean((tables[0] - tables[1]) ** 2)) < 0.01


def test_low_rank_tables_are_built_converted_and_described(sphere: Path, tmp_path: Path) -> None:
    run(amc, "build", sphere, "-o", tmp_path / "x.amc.exr", "--size", 24, "--rank", 5)
    facts = json.loads(run(amc, "info", tmp_path / "x.amc.exr", "--json").output)
    assert (facts["rank"], facts["depth"], facts["invariance"]) == (5, 8, 2)
    run(amc, "convert", tmp_path / "x.amc.exr", tmp_path / "x.amc.ktx2")
    run(amc, "build", sphere, "-o", tmp_path / "whole.amc.ktx2", "--size", 24)
    low, whole = (read_amc(tmp_path / name) for name in ("x.amc.ktx2", "whole.amc.ktx2"))
    assert 0 < np.abs(low.slices - whole.slices)[whole.valid].max() < 0.1


def test_the_isotropic_matcap_is_the_mean_of_the_slices(sphere: Path, tmp_path: Path) -> None:
    run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", "--size", 24)
    run(amc, "isotropic", tmp_path / "x.amc.ktx2", "-o", tmp_path / "x.exr")
    mean = read_amc(tmp_path / "x.amc.ktx2").slices.mean(axis=0)
    assert read_linear(tmp_path / "x.exr") == pytest.approx(mean, abs=1e-6)


def test_a_photograph_of_a_ball_becomes_a_matcap(tmp_path: Path) -> None:
    scene = Scene("isotropic", (159.3, 134.8, 106.4), (270, 318), background="clutter")
    write_picture(tmp_path / "ball.png", scene.picture(0).astype(np.float32))
    result = run(amc, "matcap", tmp_path / "ball.png", "-o", tmp_path / "x.png", "--size", 64)
    assert "ball: centre 159." in result.output
    truth, radius = true_table("isotropic", 64, np.zeros(1))
    made = read_linear(tmp_path / "x.png")
    assert np.sqrt(np.mean((made - truth[0])[radius < 0.9] ** 2)) < 0.02


def test_amc_info_speaks_json(sphere: Path, tmp_path: Path) -> None:
    out = tmp_path / "x.amc.ktx2"
    run(amc, "build", sphere, "-o", out, "--size", 16, "--invariance", "isotropic")
    facts = json.loads(run(amc, "info", out, "--json").output)
    assert (facts["size"], facts["depth"], facts["invariance"], facts["captured_slices"]) == (16, 1, "isotropic", 16)
    assert "invariance: isotropic" in run(amc, "info", out).output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        pytest.param(["--invariance", "often"], "'often' is neither", id="invariance in words"),
        pytest.param(["--invariance", "9" * 5000], "neither auto, isotropic nor", id="invariance of 5000 digits"),
        pytest.param(["--normal", "sideways"], "sideways", id="no such normal"),
        pytest.param(["--distance", "8", "--camera", "c.toml"], "give one", id="two distances"),
        pytest.param(["--circle", "1", "2"], "3", id="two of three numbers"),
    ],
)
def test_wrong_usage_is_status_two(arguments: list[str], message: str, sphere: Path, tmp_path: Path) -> None:
    result = run(amc, "build", sphere, "-o", tmp_path / "x.amc.ktx2", *arguments)
    assert result.exit_code == 2
    assert message in result.output


@pytest.mark.parametrize(
    ("name", "message"),
    [
        pytest.param("x.png", r"x\.png: cannot be written as \.png", id="wrong ending"),
        pytest.param("x.ktx2", r"cannot be written as \.ktx2; end it in \.amc\.ktx2", id="half the ending"),
        pytest.param("nowhere/x.amc.ktx2", "nowhere does not exist", id="no such folder"),
    ],
)
def test_an_output_that_cannot_be_is_refused_before_the_work(
    name: str, message: str, sphere: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        run(amc, "build", sphere, "-o", tmp_path / name)


def test_fit_writes_the_ptm_and_says_how_well_it_fits(relief: Path, tmp_path: Path) -> None:
    out = tmp_path / "x.ptm"
    result = run(ptm, "fit", relief, "-o", out)
    assert "dB over 12 pictures and 576 pixels; as stored" in result.output
    assert "24 × 24 pixels, PTM of 6 terms, lrgb, srgb" in result.output
    lights = [line.split() for line in result.output.splitlines() if line.startswith("light_") and ".png  " in line]
    assert [light[0] for light in lights] == [f"light_{index:03d}.png" for index in range(12)]
    predicted = {light[0]: float(light[3]) for light in lights}
    assert f"worst {min(predicted, key=predicted.__getitem__)} " in result.output
    assert read_ptm(out).source


def test_fit_takes_every_option(relief: Path, tmp_path: Path) -> None:
    """The list names eleven of the twelve pictures, so that it is seen to be used."""
    short = tmp_path / "short.lp"
    lines = (relief / "relief.lp").read_text().splitlines()
    short.write_text("\n".join(["11", *lines[1:12]]))
    out = tmp_path / "x.ptm"
    result = run(ptm, "fit", relief, "-o", out, "--lp", short, "--colour", "rgb", "--space", "linear")
    assert "over 11 pictures" in result.output
    facts = json.loads(run(ptm, "info", out, "--json").output)
    assert (facts["width"], facts["height"], facts["colour"], facts["space"]) == (24, 24, "rgb", "linear")
    lines = run(ptm, "info", out).output.splitlines()
    assert "space: linear" in lines
    coefficients = lines[lines.index("coefficients:") + 1 :][:6]
    assert [line.split(":")[0] for line in coefficients] == ["  u2", "  v2", "  uv", "  u", "  v", "  1"]


def test_fit_answers_a_program(relief: Path, tmp_path: Path) -> None:
    result = run(ptm, "fit", relief, "-o", tmp_path / "x.ptm", "--robust", "trimmed", "--json")
    facts = json.loads(result.stdout)
    assert len(facts["pictures"]) == 12
    assert facts["worst"][0] in [picture["name"] for picture in facts["pictures"]]
    assert 0.5 < facts["kept_share"] < 1
    assert facts["predicted_db"] < facts["fit_db"]


def test_few_lights_are_fitted_with_fewer_terms_or_held_down(relief: Path, tmp_path: Path) -> None:
    four = tmp_path / "four.lp"
    lines = (relief / "relief.lp").read_text().splitlines()
    four.write_text("\n".join(["4", *lines[1:5]]))
    arguments = ["fit", relief, "-o", tmp_path / "x.ptm", "--lp", four]
    with pytest.raises(InputError, match=r"4 lights from 4 directions cannot carry a PTM of 6 terms.*--ridge"):
        run(ptm, *arguments)
    assert not (tmp_path / "x.ptm").exists()
    assert "PTM of 3 terms" in run(ptm, *arguments, "--terms", 3).output
    assert read_ptm(tmp_path / "x.ptm").coefficients[:3] == pytest.approx(0)
    assert "PTM of 6 terms" in run(ptm, *arguments, "--ridge", 0.01).output


def test_positions_make_lights_near(relief: Path, tmp_path: Path) -> None:
    positions = tmp_path / "positions.lp"
    lines = (relief / "relief.lp").read_text().splitlines()
    far = [line.split() for line in lines[1:]]
    vectors = [" ".join([name, *(f"{300 * float(part):.3f}" for part in parts)]) for name, *parts in far]
    positions.write_text("\n".join([lines[0], *vectors]))
    arguments = ["fit", relief, "-o", tmp_path / "x.ptm", "--lp", positions]
    assert "near" not in run(ptm, *arguments).output
    assert "near lights" in run(ptm, *arguments, "--picture-width", 80).output
    assert "near" not in run(ptm, *arguments, "--picture-width", 80, "--far").output
    with pytest.raises(InputError, match=r"where its lights stood is not known.*--picture-width"):
        run(ptm, "fit", relief, "-o", tmp_path / "x.ptm", "--picture-width", 80)


def test_a_number_of_terms_that_no_basis_has_is_wrong_usage(relief: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(ptm, ["fit", str(relief), "-o", str(tmp_path / "x.ptm"), "--terms", "5"])
    assert result.exit_code == 2
    assert "ptm has 6 or 3" in result.output


def test_lights_without_names_are_paired_in_order_and_it_is_said(relief: Path, tmp_path: Path) -> None:
    lines = (relief / "relief.lp").read_text().splitlines()
    (tmp_path / "bare.lp").write_text("\n".join(line.split(" ", 1)[-1] for line in lines))
    result = run(ptm, "fit", relief, "-o", tmp_path / "x.ptm", "--lp", tmp_path / "bare.lp")
    assert "bare.lp: names no pictures; paired in their order, light_000.png first" in result.stderr
    run(ptm, "fit", relief, "-o", tmp_path / "y.ptm")
    assert (tmp_path / "x.ptm").read_bytes() == (tmp_path / "y.ptm").read_bytes()


def test_pictures_without_lights_are_refused(sphere: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"frame_0000\.png: its light is not known.*--lp"):
        run(ptm, "fit", sphere, "-o", tmp_path / "x.ptm")


@pytest.mark.parametrize("words", [["build"], ["info"], ["isotropic"], ["matcap"], ["convert"]])
def test_every_amc_command_has_help_and_an_example(words: list[str]) -> None:
    assert f"Example: litrig amc {words[0]}" in " ".join(run(amc, *words, "--help").output.split())


@pytest.mark.parametrize("words", [["fit"], ["info"], ["relight"], ["convert"]])
def test_every_ptm_command_has_help_and_an_example(words: list[str]) -> None:
    assert f"Example: litrig ptm {words[0]}" in " ".join(run(ptm, *words, "--help").output.split())
