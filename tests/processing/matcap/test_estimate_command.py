import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from litrig.base.pictures import read_encoded, write_picture
from processing.matcap.cli import matcap
from tests.processing.matcap.estimate.primitives import Primitive, matcap_of

LIGHT = Primitive("spot", theta=0.7, deviation=0.14)


@pytest.fixture
def picture(tmp_path: Path) -> Path:
    path = tmp_path / "spot.png"
    write_picture(path, matcap_of(LIGHT, size=96) * [1.0, 0.5, 0.25])
    return path


def run(*arguments: object) -> str:
    result = CliRunner().invoke(matcap, ["estimate", *map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_it_says_filter_size_slope_and_base_colour(picture: Path) -> None:
    region = LIGHT.region(96)
    output = run(picture, "--roi", region.x, region.y, region.width, region.height)
    assert "filter size ν: 0.0196 rad², a standard deviation of 8.0" in output
    assert "slope μ: 0.994" in output
    assert "base colour: 0.94" in output
    assert f"* region {region}, values" in output


def test_low_and_high_frequencies_have_filters_of_their_own(tmp_path: Path) -> None:
    along = (2 * np.arange(96) + 1) / 96 - 1
    matt = 0.4 * np.sqrt(np.clip(1 - along**2 - along[:, None] ** 2, 0, None))[..., None].repeat(3, axis=2)
    path = tmp_path / "glossy.exr"
    write_picture(path, (matt + 0.5 * matcap_of(LIGHT, size=96, bits=False)).astype(np.float32))
    low, high = (json.loads(run(path, "--component", name, "--json")) for name in ("low", "high"))
    assert high["filter_size"] == pytest.approx(LIGHT.variance, rel=0.1)
    assert low["filter_size"] > 10 * high["filter_size"]
    assert low["base_colour"][0] == pytest.approx(0.4, rel=0.1)


def test_a_program_reads_the_same_as_json(picture: Path) -> None:
    facts = json.loads(run(picture, "--json"))
    assert facts["filter_size"] == pytest.approx(LIGHT.variance, rel=0.05)
    assert facts["base_colour"][1] / facts["base_colour"][0] == pytest.approx(0.5, abs=0.01)
    assert facts["regions"][facts["chosen"]]["trusted"] is True


def test_the_signatures_are_drawn(picture: Path, tmp_path: Path) -> None:
    region = LIGHT.region(96, side=2)
    run(picture, "--roi", region.x, region.y, 2, 2, "--of", "values", "--plot", tmp_path / "signatures.png")
    drawn = read_encoded(tmp_path / "signatures.png")
    bright = drawn.min(axis=2) > 0.8
    assert drawn.shape[1] > 600
    assert 200 < bright.sum() < bright.size / 10


def test_a_degenerate_region_is_valid_json_too(picture: Path) -> None:
    dark = Primitive("spot", 0.7, 0.1, phi=0.7 + 1.57).region(96, side=2)
    facts = json.loads(run(picture, "--roi", dark.x, dark.y, 2, 2, "--json"))
    assert facts["chosen"] is None
    assert facts["regions"][0]["variance"] is None


def test_a_plot_is_not_drawn_over_the_picture(tmp_path: Path) -> None:
    (tmp_path / "x.png").write_bytes(b"mine")
    result = CliRunner().invoke(matcap, ["estimate", str(tmp_path / "x.png"), "--plot", str(tmp_path / "x.png")])
    assert "x.png: is read; write to another name" in str(result.exception)
    assert (tmp_path / "x.png").read_bytes() == b"mine"


def test_a_quantile_that_is_no_number_is_wrong_usage(picture: Path) -> None:
    assert CliRunner().invoke(matcap, ["estimate", str(picture), "--quantile", "nan"]).exit_code == 2


@pytest.mark.parametrize("arguments", [("--roi", "0", "0", "2", "2"), ("--plot", "no-such-folder/x.png")])
def test_wrong_input_is_named_and_nothing_is_written(picture: Path, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    result = CliRunner().invoke(matcap, ["estimate", str(picture), *arguments])
    assert type(result.exception).__name__ == "InputError"
    assert str(picture) in str(result.exception) or "no-such-folder" in str(result.exception)
    assert list(tmp_path.iterdir()) == [picture]
