"""`litrig matcap edit` and `info`."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear, write_picture
from processing.matcap.cli import matcap
from processing.matcap.matcap_exr import read_matcap, write_matcap
from processing.matcap.render import disc_picture
from tests.processing.matcap.maps import analytic

MATCAP = dataclasses.replace(analytic(48), picture_size=40)


def run(*arguments: object) -> Result:
    result = CliRunner().invoke(matcap, [str(argument) for argument in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


@pytest.fixture
def gold(tmp_path: Path) -> Path:
    write_matcap(tmp_path / "gold.matcap.exr", MATCAP)
    return tmp_path / "gold.matcap.exr"


def test_no_edit_gives_the_picture_at_the_source_s_size(gold: Path, tmp_path: Path) -> None:
    assert run("edit", gold, "-o", tmp_path / "same.png").exit_code == 0
    write_picture(tmp_path / "wanted.png", disc_picture(MATCAP))
    np.testing.assert_array_equal(read_codes(tmp_path / "same.png"), read_codes(tmp_path / "wanted.png"))
    assert read_codes(tmp_path / "same.png").shape == (40, 40, 3)


def test_options_and_the_recipe_that_they_save_do_the_same(gold: Path, tmp_path: Path) -> None:
    options = ["--rotate", "y", 30, "--rotate", "1,0,0", -10, "--hue", 40, "--saturation", 1.2, "--value", 0.9]
    options += ["--colour-of", "low", "--gain", 0.8, 1.3, "--silhouette", 40, 0.5, 1, "--silhouette-of", "high"]
    options += ["--paint", -0.3, 0.4, 6, 1, 0.5, 0.2, "--roughness", 12]
    (tmp_path / "recipes").mkdir()
    recipe = tmp_path / "recipes" / "x.recipe.toml"
    told = run("edit", gold, "-o", tmp_path / "a.exr", *options, "--save-recipe", recipe)
    assert "7 steps" in told.output
    assert f"steps on {gold}: 7/7  paint" in told.stderr
    run("edit", gold, "-o", tmp_path / "b.exr", "--recipe", recipe)
    run("edit", gold, "-o", tmp_path / "c.matcap.exr", "--recipe", recipe)
    run("edit", tmp_path / "c.matcap.exr", "-o", tmp_path / "d.exr")
    pictures = [read_linear(tmp_path / f"{name}.exr") for name in "abd"]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    np.testing.assert_allclose(pictures[0], pictures[2], atol=1e-6)
    assert np.abs(pictures[0] - disc_picture(MATCAP)).max() > 0.1


def test_files_named_by_options_are_found_from_the_saved_recipe(gold: Path, tmp_path: Path) -> None:
    write_matcap(tmp_path / "b.matcap.exr", analytic(32, slopes=(0.1, 0.5)))
    (tmp_path / "recipes").mkdir()
    recipe = tmp_path / "recipes" / "x.recipe.toml"
    run("edit", gold, "-o", tmp_path / "a.png", "--take-high", tmp_path / "b.matcap.exr", "--save-recipe", recipe)
    run("edit", gold, "-o", tmp_path / "y.matcap.exr", "--recipe", recipe)
    assert read_matcap(tmp_path / "y.matcap.exr").high.slope == 0.5


def test_an_edited_file_holds_everything_that_was_done(gold: Path, tmp_path: Path) -> None:
    (tmp_path / "x.recipe.toml").write_text(
        '[[steps]]\nop = "hang"\nimage = "flag.png"\nat = [0.2, 0.1]\nname = "flag"\nturn_deg = 10\n'
        '[[steps]]\nop = "paint"\nshape = "edge"\nat = [0.0, 0.0]\nto = [0.0, 0.3]\ncomponent = "low"\n'
    )
    write_picture(tmp_path / "flag.png", np.linspace(0, 1, 72).reshape(4, 6, 3))
    run("edit", gold, "-o", tmp_path / "y.matcap.exr", "--recipe", tmp_path / "x.recipe.toml", "--rotate", "z", 5)
    (tmp_path / "flag.png").unlink()
    found = read_matcap(tmp_path / "y.matcap.exr")
    assert found.high.pictures[0].texels.shape == (4, 6, 4)
    assert found.low.lights[0].shape == "edge"
    told = json.loads(run("info", tmp_path / "y.matcap.exr", "--json").output)
    assert told["high"]["light_turn_deg"] == pytest.approx([0, 0, 5])
    assert told["map_size"] == 48 and told["picture_size"] == 40
    lines = run("info", tmp_path / "y.matcap.exr").output
    assert "picture: flag" in lines and "light: edge" in lines and "slope 0.9" in lines


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--rotate", "w", 30], "'w' is no axis"),
        (["--rotate", "0,0,0", 30], "an axis of no length"),
        (["--rotate", "nan,0,1", 30], "'nan,0,1' is no axis"),
        (["--paint", 1, 1, 5, 1, 1, 1], "is not on the ball"),
        (["--gain", -1, 1], "greater than or equal to 0"),
        (["--paint", 0, 0, 5, 1e300, 1, 1], "less than or equal to 10000000000"),
        (["--silhouette", 90, 1, 1], "less than 90"),
        (["--roughness", -4], "greater than or equal to 0"),
        (["--roughness", 1e300], "less than or equal to 180"),
        (["--rotate", "y", 1e300], "less than or equal to 1000000"),
        (["--rotate", "y", "nan"], "finite number"),
    ],
)
def test_what_makes_no_sense_is_wrong_usage(gold: Path, tmp_path: Path, options: list[object], reason: str) -> None:
    result = run("edit", gold, "-o", tmp_path / "y.png", *options)
    assert result.exit_code == 2 and reason in result.output
    assert not (tmp_path / "y.png").exists()


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ('op = "move"\nname = "flag"', "step 2, move: no picture hangs under the name 'flag'"),
        (
            'op = "paint"\nshape = "line"\nat = [1, 0]\nto = [0, 1]',
            "step 2, paint: at 1, 0 and to 0, 1 the ball shows the",
        ),
        (
            'op = "paint"\nshape = "edge"\nat = [0, 0]\nto = [0, 1]',
            "step 2, paint: at 0, 0 and to 0, 1 the ball shows the",
        ),
    ],
)
def test_a_step_that_cannot_be_done_is_named_with_its_recipe(tmp_path: Path, step: str, reason: str) -> None:
    write_matcap(tmp_path / "mirror.matcap.exr", analytic(32, slopes=(1.0, 1.0)))
    (tmp_path / "x.recipe.toml").write_text(f"[[steps]]\nop = 'gain'\n[[steps]]\n{step}")
    with pytest.raises(InputError, match=rf"x\.recipe\.toml: {reason}"):
        run("edit", tmp_path / "mirror.matcap.exr", "-o", tmp_path / "y.png", "--recipe", tmp_path / "x.recipe.toml")
    assert not (tmp_path / "y.png").exists()


@pytest.mark.parametrize("ending", ["png", "exr"])
def test_a_ball_brighter_than_floats_is_refused(gold: Path, tmp_path: Path, ending: str) -> None:
    with pytest.raises(InputError, match=rf"y\.{ending}: the ball is brighter than files can hold"):
        run("edit", gold, "-o", tmp_path / f"y.{ending}", "--gain", 1e30, 1, "--value", 1e30)
    assert not (tmp_path / f"y.{ending}").exists()


def test_the_length_of_an_axis_does_not_matter(gold: Path, tmp_path: Path) -> None:
    for name, axis in (("a", "1,1,0"), ("b", "1e300,1e300,0"), ("c", "1e-300,1e-300,0")):
        assert run("edit", gold, "-o", tmp_path / f"{name}.exr", "--rotate", axis, 30).exit_code == 0
    pictures = [read_linear(tmp_path / f"{name}.exr") for name in "abc"]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    np.testing.assert_array_equal(pictures[0], pictures[2])


def test_what_cannot_be_written_or_read_is_named(gold: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"y\.bmp: cannot be written as \.bmp"):
        run("edit", gold, "-o", tmp_path / "y.bmp")
    with pytest.raises(InputError, match=r"none\.recipe\.toml: no such file"):
        run("edit", gold, "-o", tmp_path / "y.png", "--recipe", tmp_path / "none.recipe.toml")
    with pytest.raises(InputError, match=r"x\.toml: cannot be written as \.toml; end it in \.recipe\.toml"):
        run("edit", gold, "-o", tmp_path / "y.png", "--save-recipe", tmp_path / "x.toml")
    with pytest.raises(InputError, match=r"x\.recipe\.toml: the folder .*no does not exist"):
        run("edit", gold, "-o", tmp_path / "y.png", "--save-recipe", tmp_path / "no" / "x.recipe.toml")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["gold.matcap.exr"]
