"""`litrig ptm synth` end to end."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from click.testing import CliRunner, Result

from litrig.base.errors import InputError
from processing.ptm.basis import Basis
from processing.ptm.cli import ptm
from processing.ptm.files.either import read_any, write_any
from tests.processing.ptm.synthesis.textures import bits, rough

BLOCKS = ("--block", 16)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("synthesised")
    write_any(made / "x.ptm.exr", rough(48))
    write_any(made / "x.ptm", rough(48))
    write_any(made / "y.ptm.exr", rough(40, seed=4))
    write_any(made / "rgb.ptm.exr", rough(40, "rgb"))
    write_any(made / "x.rti", rough(40, "rgb", basis=Basis("hsh", 4)))
    mask = np.zeros((48, 48), np.uint8)
    mask[20:30, 18:33] = 255
    cv2.imwrite(str(made / "mask.png"), mask)
    cv2.imwrite(str(made / "small.png"), mask[:40])
    cv2.imwrite(str(made / "guide.png"), np.tile(np.linspace(0, 255, 32).astype(np.uint8), (32, 1)))
    return made


def run(folder: Path, file: str, output: str, *options: object) -> Result:
    words = ["synth", folder / file, "-o", folder / output, *options]
    return CliRunner().invoke(ptm, [str(word) for word in words], catch_exceptions=False)


def test_it_says_what_it_made(folder: Path) -> None:
    result = run(folder, "x.ptm.exr", "a.ptm.exr", "--size", 70, 50, *BLOCKS, "--tileable", "--seed", 5)
    assert result.exit_code == 0
    assert "a.ptm.exr: 70 × 50 pixels of blocks of 16, 3 overlapping" in result.output
    assert "across the ends: percentile" in result.output
    assert read_any(folder / "a.ptm.exr").shape == (50, 70)


@pytest.mark.parametrize(
    ("file", "output"), [("x.ptm", "b.ptm"), ("x.ptm", "b-web"), ("x.rti", "b.rti"), ("x.rti", "b2.ptm.exr")]
)
def test_every_form_is_read_and_written(folder: Path, file: str, output: str) -> None:
    assert run(folder, file, output, "--size", 30, 34, *BLOCKS).exit_code == 0
    assert read_any(folder / output).shape == (34, 30)


def test_json_has_the_quality_and_what_was_chosen(folder: Path) -> None:
    result = run(folder, "x.ptm.exr", "c.ptm.exr", "--size", 60, 60, "--block", "auto", "--search", "svd", "--json")
    facts = json.loads(result.stdout)
    assert facts["block"] == facts["suggested_block"] == 12
    assert 0 < facts["seam_energy"] < 10
    assert facts["copied"] == 0
    assert facts["rejected"] == sorted(facts["rejected"])


def test_a_seed_reproduces_the_coefficients_whatever_the_search(folder: Path) -> None:
    made = []
    for name, options in (("1", ()), ("2", ("--search", "walsh")), ("3", ("--seed", 9))):
        run(folder, "x.ptm.exr", f"d{name}.ptm.exr", "--size", 50, 50, *BLOCKS, *options)
        made.append(bits(read_any(folder / f"d{name}.ptm.exr")))
    np.testing.assert_array_equal(made[0], made[1])
    assert (made[0] != made[2]).any()


def test_a_hole_is_filled_at_the_materials_own_size(folder: Path) -> None:
    assert run(folder, "x.ptm.exr", "e.ptm.exr", "--fill", folder / "mask.png", "--block", 12).exit_code == 0
    before, after = read_any(folder / "x.ptm.exr"), read_any(folder / "e.ptm.exr")
    changed = (before.coefficients != after.coefficients).any(axis=(0, 3))
    assert changed[20:30, 18:33].mean() > 0.9
    assert not changed[:15].any()


def test_guides_and_more_sources_go_together(folder: Path) -> None:
    options = ("--guide", folder / "guide.png", "--source", folder / "y.ptm.exr", "--guide-weight", 2)
    assert run(folder, "x.ptm.exr", "f.ptm.exr", "--size", 64, 40, *BLOCKS, *options).exit_code == 0
    brightness = read_any(folder / "f.ptm.exr").coefficients[5, ..., 0]
    assert brightness[:, 44:].mean() > brightness[:, :20].mean() + 0.02


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((), "say how large the result is"),
        (("--size", 0, 5), "0 is not in the range"),
        (("--size", 50, 50, "--tolerance", "nan"), "nan is not a finite number"),
        (("--size", 50, 50, "--delta", "inf"), "inf is not a finite number"),
        (("--size", 50, 50, "--seed", -1), "-1 is not in the range"),
        (("--size", 50, 50, "--block", "large"), "'large' is not a valid integer"),
        (("--size", 50, 50, "--fill", "mask.png"), "--fill keeps the size"),
        (("--fill", "mask.png", "--tileable"), "neither --guide nor --tileable"),
        (("--fill", "mask.png", "--search", "svd"), "--fill searches by fft or brute"),
        (("--size", 50, 50, "--guide-weight", 2), "are about --guide"),
    ],
)
def test_wrong_usage_is_said(folder: Path, options: tuple[object, ...], said: str) -> None:
    result = run(folder, "x.ptm.exr", "wrong.ptm.exr", *options)
    assert result.exit_code == 2
    assert said in result.output
    assert not (folder / "wrong.ptm.exr").exists()


@pytest.mark.parametrize(
    ("file", "output", "options", "said"),
    [
        ("none.ptm", "w.ptm", ("--size", 9, 9), "No such file"),
        ("x.ptm", "w.rti", ("--size", 9, 9), "holds HSH"),
        ("x.ptm", "no/w.ptm", ("--size", 9, 9), "does not exist; create it first"),
        ("x.ptm", "w.ptm", ("--size", 99, 99, "--block", 49), "x.ptm: 48 × 48 pixels hold no block of 49"),
        ("x.ptm", "w.ptm", ("--size", 99, 99, "--block", 2), "a block of 2 pixels is not used"),
        ("x.ptm", "w.ptm", ("--size", 99, 99, "--overlap", 16), "cannot overlap by 16; choose 1 to 15"),
        ("x.ptm", "w.ptm", ("--size", 20, 99, "--tileable"), "a tile of 20 pixels is smaller than a block of 30"),
        ("x.ptm", "w.ptm", ("--size", 900_000, 900_000), "GiB of memory and this machine has"),
        ("x.ptm", "w.ptm", ("--size", 9, 9, "--over", "hemisphere"), "compared over square or disc, not hemisphere"),
        ("x.ptm", "w.ptm", ("--size", 9, 9, "--source", "{}/rgb.ptm.exr"), "its colour is rgb where"),
        ("x.ptm", "w.ptm", ("--fill", "{}/small.png"), "48 × 40 pixels, where the material has 48 × 48"),
        (
            "x.ptm",
            "w.ptm",
            ("--size", 9, 9, "--guide", "{}/guide.png", "--guide-source", "{}/guide.png"),
            "32 × 32 pixels, where",
        ),
    ],
)
def test_what_cannot_be_made_is_one_line_and_leaves_nothing(
    folder: Path, file: str, output: str, options: tuple[object, ...], said: str
) -> None:
    with pytest.raises(InputError) as caught:
        run(folder, file, output, *(str(option).format(folder) for option in options))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not [path for path in folder.iterdir() if path.name.startswith(("w.", ".", "no"))]
