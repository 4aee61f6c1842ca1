"""Rendered pictures under other normals, as it is typed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError, LitrigError
from litrig.base.pictures import read_linear
from litrig.base.radiometry import encode_srgb, to_u8
from processing.reference.recompose import recompose
from processing.shape.editing.edit import edit
from processing.shape.editing.operations import Emboss, Factors, Recipe, Ripple
from processing.shape.editing.recipe_toml import write_recipe
from processing.shape.env_exr import write_environments
from processing.shape.extended.blend import recompose_regions
from processing.shape.model import Region
from processing.shape.recompose import recompose as recompose_quickly
from tests.processing.shape.scene import buffers, bumped, environments
from tests.processing.shape.stored import layers, write
from tests.viewer.test_cli import codes, run

BUFFERS, LIGHT = buffers(), environments(32)
BUMPED = bumped(BUFFERS.normals)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("buffers")
    write(folder / "scene.exr", layers(BUFFERS))
    write(folder / "bumps.exr", {name: BUMPED[..., index] for index, name in enumerate("XYZ")})
    write_environments(folder / "scene.env.exr", LIGHT)
    return folder


def test_a_picture_is_shaded_again(files: Path, tmp_path: Path) -> None:
    words: list[str | Path | float] = [
        "--environment",
        files / "scene.env.exr",
        "--normal-map",
        files / "bumps.exr",
        "--kd",
        0.5,
        "--kr",
        2,
    ]
    told = run(files / "scene.exr", "-o", tmp_path / "x.png", *words)
    assert told.endswith("150 × 120 pixels\n")
    truth = to_u8(encode_srgb(recompose(BUFFERS, LIGHT, BUMPED, diffuse_factor=0.5, reflection_factor=2)))
    assert np.quantile(np.abs(codes(tmp_path / "x.png").astype(int) - truth), 0.999) <= 2


def test_what_is_untouched_keeps_its_bits(files: Path, tmp_path: Path) -> None:
    run(files / "scene.exr", "-o", tmp_path / "x.exr", "--environment", files / "scene.env.exr")
    np.testing.assert_array_equal(read_linear(tmp_path / "x.exr"), BUFFERS.picture)


def test_a_recipe_is_carried_out_on_the_card_as_on_the_processor(files: Path, tmp_path: Path) -> None:
    edits = (
        Ripple(at=(50, 60), height=1, wavelength=14, fade=40, surfaces=(2,)),
        Emboss(beta=0.7, surfaces=(7,)),
        Factors(diffuse=0.5, surfaces=(7,)),
    )
    write_recipe(tmp_path / "x.recipe.toml", Recipe(steps=edits))
    words: list[str | Path | float] = ["--environment", files / "scene.env.exr", "--recipe", tmp_path / "x.recipe.toml"]
    run(files / "scene.exr", "-o", tmp_path / "x.exr", *words)
    edited = edit(BUFFERS, Recipe(steps=edits))
    truth = recompose_quickly(
        *(BUFFERS, LIGHT, edited.normals),
        diffuse_factor=edited.diffuse_factor,
        reflection_factor=edited.reflection_factor,
    )
    drawn = read_linear(tmp_path / "x.exr")
    assert np.abs(truth - BUFFERS.picture).max() > 0.1
    assert np.quantile(np.abs(encode_srgb(drawn) - encode_srgb(truth)), 0.999) <= 2 / 255


def test_regions_of_an_extended_surface_are_blended_as_on_the_processor(files: Path, tmp_path: Path) -> None:
    regions = tuple(Region(np.array([x, 0, -4], np.float32), LIGHT[number]) for x, number in ((-0.9, 2), (-0.2, 7)))
    light = {2: replace(LIGHT[2], regions=regions, falloff=0.3), 7: LIGHT[7]}
    write_environments(tmp_path / "x.env.exr", light)
    words: list[str | Path | float] = ["--environment", tmp_path / "x.env.exr", "--normal-map", files / "bumps.exr"]
    run(files / "scene.exr", "-o", tmp_path / "x.exr", *words)
    truth = recompose_regions(recompose, BUFFERS, light, BUMPED)
    assert np.abs(truth - recompose(BUFFERS, LIGHT, BUMPED)).max() > 0.1
    drawn = read_linear(tmp_path / "x.exr")
    assert np.quantile(np.abs(encode_srgb(drawn) - encode_srgb(truth)), 0.999) <= 2 / 255


def test_remarks_on_the_buffers_are_said(files: Path, tmp_path: Path) -> None:
    stored = {name: plane for name, plane in layers(BUFFERS).items() if "occlusion" not in name}
    write(tmp_path / "s.exr", stored)
    told = run(tmp_path / "s.exr", "-o", tmp_path / "x.png", "--environment", files / "scene.env.exr")
    assert "note: no ambient occlusion" in told and told.endswith("150 × 120 pixels\n")
    stored["R"] = np.where(np.arange(150) == 70, np.float32(np.nan), stored["R"])
    write(tmp_path / "s.exr", stored)
    told = run(tmp_path / "s.exr", "-o", tmp_path / "x.png", "--environment", files / "scene.env.exr")
    assert "120 pixels hold no numbers, and are black in x.png" in told
    assert not codes(tmp_path / "x.png")[:, 70, 0].any()


@pytest.mark.parametrize("name", ["scene.exr", "bumps.exr", "scene.env.exr"])
def test_a_flipped_bit_is_one_line_or_a_picture(files: Path, tmp_path: Path, name: str) -> None:
    for file in files.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    content = (files / name).read_bytes()
    words: list[str | Path | float] = [
        "--environment",
        tmp_path / "scene.env.exr",
        "--normal-map",
        tmp_path / "bumps.exr",
    ]
    random = np.random.default_rng(4)
    for place in [*random.integers(0, 1500, 6), *random.integers(0, len(content), 4)]:
        changed = bytearray(content)
        changed[place] ^= 1 << int(random.integers(0, 8))
        (tmp_path / name).write_bytes(bytes(changed))
        try:
            run(tmp_path / "scene.exr", "-o", tmp_path / "x.png", *words)
        except LitrigError as error:
            assert "\n" not in str(error)
            assert name in str(error)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["scene.exr", "--normal-map", "bumps.exr"], "give those with --environment"),
        (["scene.exr", "--recipe", "x.recipe.toml"], "--recipe .but for a rendered picture with its --environment"),
        (["scene.exr", "--kd", "2"], "give those with --environment"),
        (["scene.exr", "--environment", "no.env.exr"], "(?i)no such file"),
        (["scene.exr", "--environment", "scene.exr"], "is of kind none, not environments"),
        (["bumps.exr", "--environment", "scene.env.exr"], "lacks R, G, B, diffuse.R"),
        (["scene.exr", "--environment", "scene.env.exr", "--kr", "nan"], "are no numbers"),
        (["scene.exr", "--environment", "scene.env.exr", "--mesh", "torus"], "is no mesh"),
        (["scene.exr", "--environment", "scene.env.exr", "--yaw", "5"], "--yaw would not change"),
        (["scene.exr", "--environment", "scene.env.exr", "--light", "0", "0"], "has its light in it"),
        (["scene.exr", "--environment", "scene.env.exr", "--turn", "5"], "no grain"),
        (["scene.exr", "--environment", "scene.env.exr", "--turntable", "5", "-o", "x.mp4"], "does not move"),
        (["scene.exr"], "are no MatCap|no RGB"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_does_not_go_together_is_one_clear_error(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], reason: str
) -> None:
    monkeypatch.chdir(files)
    before = sorted(files.iterdir())
    out = [] if "-o" in arguments else ["-o", str(tmp_path / "x.png")]
    with pytest.raises(InputError, match=reason) as caught:
        run(*arguments, *out)
    assert "\n" not in str(caught.value)
    assert sorted(files.iterdir()) == before and not any(tmp_path.iterdir())
