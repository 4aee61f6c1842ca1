"""`litrig ptm relight` end to end; what the effects compute is tested beside them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import read_codes, read_linear, write_picture
from litrig.base.radiometry import decode_srgb, encode_srgb
from processing.ptm.cli import ptm
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.model import Space
from processing.ptm.relighting.diffuse_gain import gain_diffuse
from processing.ptm.relighting.environment import environment_lights
from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.lights import lamps
from processing.ptm.relighting.many_lights import relight_by_many
from processing.ptm.relighting.normals import normals_of
from processing.ptm.relighting.relight import relight
from processing.ptm.relighting.unsharp import sharpen
from tests.processing.ptm.relighting.materials import lambert, sphere_normals

LIGHT = ("--light", 0.3, -0.4)
DIRECTION = lamps([(0.3, -0.4)]).directions[0]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("relit")
    for space in ("srgb", "linear"):
        write_ptm(made / f"{space}.ptm", lambert(sphere_normals(16), space=space))
    write_picture(made / "sky.exr", np.random.default_rng(2).uniform(0, 2, (8, 16, 3)))
    write_picture(made / "square.png", np.ones((8, 8, 3)))
    return made


def run(folder: Path, output: str, *options: object, space: str = "srgb") -> Result:
    """Run the command; what it raises is raised here."""
    words = ["relight", folder / f"{space}.ptm", *options, "-o", folder / output]
    return CliRunner().invoke(ptm, [str(word) for word in words], catch_exceptions=False)


def codes(values: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(np.rint(np.clip(values, 0, 1) * 255), np.float32)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_one_light_gives_the_stored_values_or_light(space: Space, folder: Path) -> None:
    values = relight(read_ptm(folder / f"{space}.ptm"), np.array(LIGHT[1:], float))
    assert run(folder, "lit.png", *LIGHT, space=space).exit_code == 0
    assert np.array_equal(read_codes(folder / "lit.png"), codes(values))
    run(folder, "lit.exr", *LIGHT, space=space)
    light = decode_srgb(values) if space == "srgb" else values
    assert np.array_equal(read_linear(folder / "lit.exr"), light)


def test_every_effect_is_applied(folder: Path) -> None:
    """The highlight keeps to the normals of the material as it was fitted."""
    fitted = read_ptm(folder / "srgb.ptm")
    options = "--diffuse-gain 2 --unsharp 1.5 --unsharp-radius 3 --specular 0.3 40 --diffuse-weight 0.6"
    run(folder, "lit.png", *LIGHT, *options.split())
    material = sharpen(gain_diffuse(fitted, 2), 1.5, 3)
    material = replace(material, coefficients=material.coefficients * np.float32(0.6))
    values = shade(material, DIRECTION, Highlight(normals_of(fitted), 0.3, 40))
    assert np.array_equal(read_codes(folder / "lit.png"), codes(values))


@pytest.mark.parametrize(
    "option", ["--diffuse-gain 2", "--unsharp 1", "--specular 0.5 9", "--diffuse-weight 0.5", "--exposure -1"]
)
def test_each_effect_alone_changes_the_picture(option: str, folder: Path) -> None:
    run(folder, "plain.png", *LIGHT)
    run(folder, "lit.png", *LIGHT, *option.split())
    assert np.abs(read_codes(folder / "lit.png").astype(int) - read_codes(folder / "plain.png")).max() > 10


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_lamps_and_an_environment_add_up(space: Space, folder: Path) -> None:
    options = "--light 0.5 0 --light -0.5 0.2 --light-colour 1 0.5 0 --light-colour 0 0.2 1 --rotate 30 --exposure -0.5"
    run(folder, "lit.exr", *options.split(), "--environment", folder / "sky.exr", space=space)
    lights = lamps([(0.5, 0), (-0.5, 0.2)], [(1, 0.5, 0), (0, 0.2, 1)])
    lights = lights.and_also(environment_lights(read_linear(folder / "sky.exr"), 30)).exposed(-0.5)
    expected = relight_by_many(read_ptm(folder / f"{space}.ptm"), lights)
    assert read_linear(folder / "lit.exr") == pytest.approx(expected, abs=1e-6)
    run(folder, "lit.png", *options.split(), "--environment", folder / "sky.exr", space=space)
    values = encode_srgb(expected) if space == "srgb" else expected
    assert np.array_equal(read_codes(folder / "lit.png"), codes(values))


def test_light_that_changes_nothing_changes_nothing(folder: Path) -> None:
    """The way through linear light and back gives the plain picture."""
    run(folder, "plain.png", *LIGHT)
    run(folder, "lit.png", *LIGHT, "--exposure", 0)
    assert np.array_equal(read_codes(folder / "lit.png"), read_codes(folder / "plain.png"))


def test_one_light_may_have_a_colour(folder: Path) -> None:
    run(folder, "lit.exr", *LIGHT, "--light-colour", 0.5, 0, 2)
    light = decode_srgb(relight(read_ptm(folder / "srgb.ptm"), DIRECTION))
    assert read_linear(folder / "lit.exr") == pytest.approx(light * [0.5, 0, 2], abs=1e-6)


def test_what_is_too_bright_is_said(folder: Path) -> None:
    assert "brighter than white" in run(folder, "lit.png", *LIGHT, "--exposure", 4).output
    assert "brighter than white" not in run(folder, "lit.exr", *LIGHT, "--exposure", 4).output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        pytest.param("", "name a light", id="no light"),
        pytest.param("--light 0 0 --light-colour 1 1 1 --light-colour 1 1 1", "give one for each", id="colours"),
        pytest.param("--light 0 0 --rotate 5", "turns an environment", id="nothing to turn"),
        pytest.param("--light 0 0 --unsharp-radius 5", "give that too", id="radius alone"),
        pytest.param("--light 0 0 --unsharp nan", "nan is not a finite number", id="NaN"),
        pytest.param("--light 0 0 --diffuse-gain inf", "inf is not a finite number", id="infinite"),
        pytest.param("--light 0 0 --diffuse-gain -1", "not in the range x>=0", id="negative"),
        pytest.param("--light 0 0 --specular 1 0", "not in the range x>0", id="exponent of zero"),
        pytest.param("--light 0 0 --exposure 1e9", "not in the range -30<=x<=30", id="overflow"),
    ],
)
def test_wrong_usage(options: str, message: str, folder: Path) -> None:
    result = run(folder, "never.png", *options.split())
    assert result.exit_code == 2
    assert message in " ".join(result.output.split())
    assert not (folder / "never.png").exists()


@pytest.mark.parametrize(
    ("output", "options", "message"),
    [
        pytest.param("never.png", "--light 0.8 0.8", r"0\.8, 0\.8 is below the horizon", id="below the horizon"),
        pytest.param("never.png", "--light 0 0 --light nan 0", "nan, 0 is below the horizon", id="NaN"),
        pytest.param("never.png", "--environment none.exr", r"none\.exr: no such file", id="no such environment"),
        pytest.param("never.png", "--environment FOLDER/square.png", r"square\.png: 8 × 8 pixels", id="no panorama"),
        pytest.param("never.gif", "--light 0 0", r"never\.gif: cannot be written as \.gif", id="unknown ending"),
        pytest.param("no/never.png", "--light 0 0", "does not exist; create it first", id="no such folder"),
    ],
)
def test_wrong_input(output: str, options: str, message: str, folder: Path) -> None:
    with pytest.raises(InputError, match=message):
        run(folder, output, *options.replace("FOLDER", str(folder)).split())
    assert not (folder / output).exists()
