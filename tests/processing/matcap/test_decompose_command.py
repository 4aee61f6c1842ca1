import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from litrig.base.errors import LitrigError
from litrig.base.pictures import read_codes, write_codes, write_picture
from litrig.base.table_normals import TableNormal
from processing.matcap.cli import matcap
from processing.matcap.disc import rim_distances_px
from processing.matcap.filter import slope_of
from processing.matcap.matcap_exr import read_matcap
from processing.matcap.render import disc_picture
from tests.processing.matcap.discs import glossy, hard_edged

SIZES = ("--filter-sizes", 0.45, 0.05)


def run(*arguments: object) -> Result:
    return CliRunner().invoke(matcap, ["decompose", *(str(argument) for argument in arguments)])


def test_the_file_draws_the_picture_that_went_in(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.png", hard_edged(64))
    found = run(tmp_path / "x.png", "-o", tmp_path / "x.matcap.exr", *SIZES, "--json")
    assert found.exit_code == 0, found.output
    kept = read_matcap(tmp_path / "x.matcap.exr")
    CliRunner().invoke(matcap, ["edit", str(tmp_path / "x.matcap.exr"), "-o", str(tmp_path / "same.png")])
    np.testing.assert_array_equal(read_codes(tmp_path / "same.png"), read_codes(tmp_path / "x.png"))
    told = json.loads(found.stdout)
    assert (told["low_filter_size"], told["high_slope"]) == (0.45, pytest.approx(slope_of(0.05), abs=1e-4))
    assert "decompose: 3/3  maps" in found.stderr
    assert told["size"] == 128 and kept.picture_size == 64 and len(kept.source) == 64


def test_layers_of_the_artist_go_in_as_they_are(tmp_path: Path) -> None:
    low, high = glossy(32) * 0.3, np.zeros((32, 32, 3))
    high[10:14, 12:20] = (0.5, 0.4, 0.3)
    write_picture(tmp_path / "l.exr", low)
    write_picture(tmp_path / "h.exr", high)
    layers = (tmp_path / "l.exr", tmp_path / "h.exr")
    for blend, whole in (("add", low + high), ("screen", low + high - low * high), ("lighten", np.maximum(low, high))):
        found = run(*layers, "-o", tmp_path / "x.matcap.exr", *SIZES, "--blend", blend)
        assert found.exit_code == 0, found.output
        kept = read_matcap(tmp_path / "x.matcap.exr")
        seen = rim_distances_px(32) >= 2
        np.testing.assert_allclose(disc_picture(kept)[seen], whole[seen], atol=1e-3)
    assert not kept.high.front.min() < 0


def test_slopes_can_be_given_instead_of_sizes_or_besides(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.exr", glossy(32))
    common = (
        tmp_path / "x.exr",
        "-o",
        tmp_path / "x.matcap.exr",
        "--size",
        64,
        "--normal",
        "view",
        "--slopes",
        0.2,
        0.9,
    )
    assert run(*common).exit_code == 0
    alone = read_matcap(tmp_path / "x.matcap.exr")
    assert (alone.low.slope, alone.high.slope) == (0.2, 0.9)
    assert slope_of(alone.high.filter_size) == pytest.approx(0.9) and alone.table_normal is TableNormal.VIEW
    assert run(*common, *SIZES).exit_code == 0
    both = read_matcap(tmp_path / "x.matcap.exr")
    assert (both.high.slope, both.high.filter_size, both.low.front.shape) == (0.9, 0.05, (64, 64, 3))


def test_filters_are_estimated_where_nobody_says_them(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.exr", glossy(96) + 0.001)
    found = run(tmp_path / "x.exr", "-o", tmp_path / "x.matcap.exr", "--size", 64, "--json")
    assert found.exit_code == 0, found.output
    # The highlight is exp(40 (cos − 1)), nearly a Gaussian of variance 1/40, less the matt shading that fits under it.
    assert json.loads(found.stdout)["high_filter_size"] == pytest.approx(1 / 40, rel=0.15)


@pytest.mark.parametrize("kind", ["png", "matcap.exr"])
def test_a_blind_spot_can_be_painted(tmp_path: Path, kind: str) -> None:
    write_picture(tmp_path / "x.exr", glossy(32))
    write_picture(tmp_path / "back.png", np.ones((16, 16, 3), np.float32))
    common = (tmp_path / "x.exr", *SIZES, "--size", 64)
    if kind == "matcap.exr":
        assert run(tmp_path / "back.png", "-o", tmp_path / "back.matcap.exr", *SIZES, "--size", 64).exit_code == 0
    assert run(*common, "-o", tmp_path / "y.matcap.exr", "--blind-spot", tmp_path / f"back.{kind}").exit_code == 0
    assert run(*common, "-o", tmp_path / "z.matcap.exr", "--blind-spot", "harmonic").exit_code == 0
    painted, plain = (read_matcap(tmp_path / f"{name}.matcap.exr").low.back for name in "yz")
    np.testing.assert_allclose(painted[31:33, 31:33], 1, atol=1e-4)
    assert np.abs(plain[31:33, 31:33] - 1).min() > 0.05
    np.testing.assert_array_equal(painted[:4], plain[:4])


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        pytest.param(("x.png", "-o", "y.exr"), "end it in .matcap.exr", id="ending"),
        pytest.param(("no.png", "-o", "y.matcap.exr"), "no such file", id="missing"),
        pytest.param(("x.png", "large.png", "-o", "y.matcap.exr"), "layers of one size", id="two sizes"),
        pytest.param(("x.png", "-o", "y.matcap.exr"), "give --filter-sizes", id="too small to estimate"),
        pytest.param(
            ("x.png", "x.png", "-o", "y.matcap.exr", "--mask", "x.png", "--rim", 1, *SIZES),
            "x.png: is taken as it is, .* leave out --mask, --rim",
            id="options that change nothing",
        ),
        pytest.param(("x.png", "-o", "y.matcap.exr", "--blend", "screen", *SIZES), "leave out --blend", id="one layer"),
        pytest.param(("clear.png", "x.png", "-o", "y.matcap.exr"), "clear.png: no pixel of the disc", id="transparent"),
        pytest.param(("x.matcap.exr", "-o", "y.matcap.exr"), "x.matcap.exr: is decomposed already", id="no picture"),
        pytest.param(("x.png", "-o", "y.matcap.exr", "--blind-spot", "gold", *SIZES), "gold", id="no such fill"),
    ],
)
def test_what_cannot_be_done_is_said_and_nothing_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[object, ...], reason: str
) -> None:
    monkeypatch.chdir(tmp_path)
    write_picture(tmp_path / "x.png", np.full((8, 8, 3), 0.5, np.float32))
    write_codes(tmp_path / "clear.png", np.zeros((8, 8, 4), np.uint8))
    write_picture(tmp_path / "large.png", np.full((16, 16, 3), 0.5, np.float32))
    found = run(*arguments)
    assert isinstance(found.exception, LitrigError), found.output
    with pytest.raises(LitrigError, match=reason):
        raise found.exception
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clear.png", "large.png", "x.png"]


def test_a_dark_base_colour_is_told_with_its_digits(tmp_path: Path) -> None:
    write_picture(tmp_path / "x.exr", glossy(32) * 1e-6)
    found = run(tmp_path / "x.exr", "-o", tmp_path / "x.matcap.exr", *SIZES, "--json")
    kept = read_matcap(tmp_path / "x.matcap.exr").low.base_colour
    assert 0 < kept[0] < 1e-5 and json.loads(found.stdout)["low_base_colour"] == pytest.approx(kept, rel=1e-4)


def test_three_pictures_are_wrong_usage(tmp_path: Path) -> None:
    assert run("a.png", "b.png", "c.png", "-o", tmp_path / "x.matcap.exr").exit_code == 2
