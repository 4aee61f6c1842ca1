import json
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
import pytest
from click.testing import CliRunner, Result

from litrig.base.errors import LitrigError
from litrig.base.pictures import read_codes, read_linear, write_exr, write_picture
from processing.matcap.cli import matcap
from processing.matcap.disc import disc_normals
from processing.matcap.separation.blend import Blend, blended
from tests.processing.matcap.discs import glossy, hard_edged, lambert


def run(*arguments: object) -> Result:
    return CliRunner().invoke(matcap, [str(argument) for argument in arguments])


@pytest.mark.parametrize("form", ["continuous", "discrete"])
def test_exr_layers_add_up_to_the_picture_and_are_not_negative(tmp_path: Path, form: str) -> None:
    write_picture(tmp_path / "x.exr", 3 * glossy(40))
    found = run("split", tmp_path / "x.exr", "-o", tmp_path / "l.exr", tmp_path / "h.exr", "--form", form)
    assert found.exit_code == 0, found.output
    low, high, whole = (read_linear(tmp_path / f"{name}.exr") for name in "lhx")
    assert low.min() >= 0 and high.min() >= 0 and high.max() > 1
    np.testing.assert_allclose(low + high, whole, rtol=2e-7, atol=1e-9)


@pytest.mark.parametrize("blend", get_args(Blend))
def test_png_layers_give_the_codes_back_within_one(tmp_path: Path, blend: Blend) -> None:
    write_picture(tmp_path / "x.png", hard_edged(48))
    found = run("split", tmp_path / "x.png", "-o", tmp_path / "l.png", tmp_path / "h.png", "--blend", blend)
    assert found.exit_code == 0, found.output
    write_picture(
        tmp_path / "both.png", blended(read_linear(tmp_path / "l.png"), read_linear(tmp_path / "h.png"), blend)
    )
    codes, wanted = (read_codes(tmp_path / name).astype(int) for name in ("both.png", "x.png"))
    _, inside = disc_normals(48)
    assert np.abs(codes - wanted)[inside].max() <= 1
    assert not codes[~inside].any()


def test_what_is_said_is_what_was_done(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.exr", lambert(40, (0, 0, 1)))
    found = run("split", tmp_path / "x.exr", "-o", tmp_path / "l.exr", tmp_path / "h.exr", "--json")
    told = json.loads(found.stdout)
    assert told["share_of_light_in_low"] == pytest.approx(1) and told["size"] == 40
    assert told["pixels"] == disc_normals(40)[1].sum()


def test_transparent_pixels_and_those_dark_in_a_mask_hold_nothing_down(tmp_path: Path) -> None:
    picture = lambert(40, (0, 0, 0.8), (1, 1, 1))
    spot = np.zeros((40, 40), bool)
    spot[12:15, 20:24] = True
    spotted = np.where(spot[..., None], 0, picture).astype(np.float32)
    alpha = np.where(spot, 0, 1).astype(np.float32)[..., None]
    write_exr(tmp_path / "alpha.exr", {"RGBA": np.concatenate([spotted, alpha], axis=-1)}, {"litrig.kind": "picture"})
    write_picture(tmp_path / "plain.exr", spotted)
    cv2.imwrite(str(tmp_path / "mask.png"), np.where(spot, 0, 255).astype(np.uint8))
    outputs = ("-o", tmp_path / "l.exr", tmp_path / "h.exr")
    for arguments in (("alpha.exr",), ("plain.exr", "--mask", tmp_path / "mask.png")):
        assert run("split", tmp_path / arguments[0], *arguments[1:], *outputs).exit_code == 0
        np.testing.assert_allclose(read_linear(tmp_path / "l.exr")[~spot], picture[~spot], atol=1e-6)
    assert run("split", tmp_path / "plain.exr", *outputs).exit_code == 0
    assert read_linear(tmp_path / "l.exr").max() < 0.7


def test_the_alpha_of_a_png_counts(tmp_path: Path) -> None:
    codes = np.full((32, 32, 4), 255, np.uint8)
    codes[..., :3] = 188
    codes[:, 20:] = 0
    cv2.imwrite(str(tmp_path / "x.png"), codes)
    found = run("split", tmp_path / "x.png", "-o", tmp_path / "l.exr", tmp_path / "h.exr", "--json")
    assert json.loads(found.stdout)["pixels"] == disc_normals(32)[1][:, :20].sum()
    assert read_linear(tmp_path / "l.exr")[16, 4:18].min() == pytest.approx(0.5, abs=0.01)


def test_a_picture_too_bright_to_be_screened_leaves_neither_layer(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.exr", np.full((8, 8, 3), 2.0, np.float32))
    layers = (tmp_path / "l.exr", tmp_path / "h.exr")
    found = run("split", tmp_path / "x.exr", "-o", *layers, "--blend", "screen")
    assert isinstance(found.exception, LitrigError) and "h.exr: a picture as bright as 2" in str(found.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["x.exr"]


@pytest.mark.parametrize("option", ["--floor", "--rim", "--percentile", "--tolerance"])
def test_what_is_no_number_is_wrong_usage(tmp_path: Path, option: str) -> None:
    write_picture(tmp_path / "x.png", np.full((8, 8, 3), 0.5, np.float32))
    found = run("split", tmp_path / "x.png", "-o", tmp_path / "l.png", tmp_path / "h.png", option, "nan")
    assert found.exit_code == 2 and "not a finite number" in found.output


@pytest.mark.parametrize(
    ("shape", "output", "reason"),
    [
        pytest.param((8, 9, 3), "l.png", "9 × 8 is no MatCap", id="not square"),
        pytest.param((8, 8, 3), "l.txt", "cannot be written as .txt", id="ending"),
        pytest.param((8, 8, 3), "no/l.png", "folder .* does not exist", id="folder"),
        pytest.param((8, 8, 3), "x.png", "x.png: is read; write to another name", id="its own input"),
        pytest.param((8, 8, 3), "h.png", "h.png: is to be written twice", id="one file for both"),
    ],
)
def test_what_cannot_be_split_is_refused_and_nothing_written(
    tmp_path: Path, shape: tuple[int, ...], output: str, reason: str
) -> None:
    write_picture(tmp_path / "x.png", np.full(shape, 0.5, np.float32))
    found = run("split", tmp_path / "x.png", "-o", tmp_path / output, tmp_path / "h.png")
    assert isinstance(found.exception, LitrigError)
    with pytest.raises(LitrigError, match=reason):
        raise found.exception
    assert [path.name for path in tmp_path.iterdir()] == ["x.png"]
