"""What `litrig render` shows of an AMC besides the table itself, and plain MatCaps, as it is typed."""

from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import InputError
from litrig.base.pictures import write_picture
from processing.amc.files.either import write_any
from processing.amc.files.ktx2 import write_amc
from processing.amc.isotropic import isotropic_matcap
from processing.amc.model import Amc
from processing.mesh.builtin import torus
from processing.ptm.files.ptm_file import write_ptm
from processing.ptm.model import Ptm
from tests.viewer.analytic import brushed_amc
from tests.viewer.scenes import KEY, lit_and_unlit, split_in_two, with_occlusion
from tests.viewer.test_cli import SMALL, codes, run

KEY_WORDS = [str(part) for part in KEY]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("materials")
    lit, unlit = lit_and_unlit(16, 8)
    write_amc(folder / "x.amc.ktx2", lit)
    write_amc(folder / "x.unlit.amc.ktx2", unlit)
    for name, half in zip(("low", "high"), split_in_two(lit), strict=True):
        write_amc(folder / f"x.{name}.amc.ktx2", half, half_float=True)
    write_amc(folder / "other.amc.ktx2", brushed_amc(16, 6))
    write_any(folder / "x.amc.exr", lit, rank=8)
    write_picture(folder / "x.png", isotropic_matcap(lit))
    write_picture(folder / "x.exr", isotropic_matcap(lit))
    write_picture(folder / "wide.png", np.zeros((4, 6, 3), np.float32))
    write_amc(folder / "plain.amc.ktx2", Amc(isotropic_matcap(lit)[None], lit.valid[:1], "isotropic"), half_float=True)
    write_ptm(folder / "coin.ptm", Ptm(np.full((6, 9, 14, 3), 0.2, np.float32), None))
    return folder


def draw(files: Path, out: Path, name: str, *options: str | Path) -> np.ndarray:
    run(files / name, "-o", out, *SMALL, *options)
    return codes(out).astype(int)


def apart(first: np.ndarray, second: np.ndarray) -> int:
    return int(np.abs(first - second).max())


def test_where_the_key_light_is_in_shadow_the_other_table_shows(files: Path, tmp_path: Path) -> None:
    options = ["--mesh", "cloth", "--pitch", "20"]
    lit, unlit = (draw(files, tmp_path / "x.png", name, *options) for name in ("x.amc.ktx2", "x.unlit.amc.ktx2"))
    key = ["--unlit", str(files / "x.unlit.amc.ktx2"), "--key", *KEY_WORDS]
    both = draw(files, tmp_path / "x.png", "x.amc.ktx2", *options, *key)
    is_lit, is_unlit = ((np.abs(both - alone) <= 1).all(axis=-1) for alone in (lit, unlit))
    shown = (lit != lit[0, 0]).any(axis=-1)
    assert 0.1 < is_lit[shown].mean() < 0.95
    assert 0.05 < is_unlit[shown].mean() < 0.9
    assert (is_lit | is_unlit)[shown].mean() > 0.9


def test_the_halves_of_a_split_table_add_up_to_the_whole(files: Path, tmp_path: Path) -> None:
    both = draw(files, tmp_path / "x.png", "x.low.amc.ktx2", "--add", files / "x.high.amc.ktx2")
    assert apart(both, draw(files, tmp_path / "x.png", "x.amc.ktx2")) <= 3
    assert apart(both, draw(files, tmp_path / "x.png", "x.low.amc.ktx2")) > 20


def test_a_low_rank_file_is_drawn_like_its_table_in_every_way(files: Path, tmp_path: Path) -> None:
    for options in ([], ["--coordinates", "vertex"]):
        pictures = [draw(files, tmp_path / "x.png", name, *options) for name in ("x.amc.exr", "x.amc.ktx2")]
        assert apart(*pictures) <= 4


def test_coordinates_can_be_found_at_vertices(files: Path, tmp_path: Path) -> None:
    ways = [draw(files, tmp_path / "x.png", "x.amc.ktx2", "--coordinates", way) for way in ("fragment", "vertex")]
    assert 0 < apart(*ways) < 60


def test_tangents_are_drawn_over_the_surface(files: Path, tmp_path: Path) -> None:
    without = draw(files, tmp_path / "x.png", "x.amc.ktx2")
    drawn = draw(files, tmp_path / "x.png", "x.amc.ktx2", "--tangents")
    changed = (without != drawn).any(axis=-1)
    assert 0.01 < changed.mean() < 0.3
    orange = drawn[changed]
    assert np.mean(orange[:, 0] > orange[:, 2] + 60) > 0.5


@pytest.mark.parametrize(("matcap", "tolerance"), [("x.png", 4), ("x.exr", 2)])
def test_a_picture_of_a_ball_is_a_material(files: Path, tmp_path: Path, matcap: str, tolerance: int) -> None:
    drawn = draw(files, tmp_path / "x.png", matcap)
    assert apart(drawn, draw(files, tmp_path / "x.png", "plain.amc.ktx2")) <= tolerance


def test_two_materials_stand_beside_each_other(files: Path, tmp_path: Path) -> None:
    turned = ["--turn", "50", "--tangents"]
    both = draw(files, tmp_path / "x.png", "x.amc.ktx2", "--beside", files / "x.png", *turned)
    assert both.shape == (40, 120, 3)
    np.testing.assert_array_equal(both[:, :60], draw(files, tmp_path / "x.png", "x.amc.ktx2", *turned))
    assert apart(both[:, 60:], draw(files, tmp_path / "x.png", "x.png", "--tangents")) > 20, "the grain is turned too"
    ptm = draw(files, tmp_path / "x.png", "coin.ptm", "--beside", files / "x.png")
    np.testing.assert_array_equal(ptm[:, 60:], draw(files, tmp_path / "x.png", "x.png"))


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        pytest.param(["x.amc.ktx2", "--unlit", "x.unlit.amc.ktx2"], "say it with --key", id="a key light nowhere"),
        pytest.param(["x.amc.ktx2", "--key", "0", "0"], "give it with --unlit", id="no table without key light"),
        pytest.param(
            ["x.amc.ktx2", "--unlit", "x.unlit.amc.ktx2", "--key", "1", "1"], "is no direction", id="a key light below"
        ),
        pytest.param(
            ["x.amc.ktx2", "--unlit", "other.amc.ktx2", "--key", "0", "0"], "differ in size, R", id="another form"
        ),
        pytest.param(
            ["x.amc.ktx2", "--unlit", "x.png", "--key", "0", "0"], r"x\.png: is no AMC by its ending", id="no AMC"
        ),
        pytest.param(
            ["x.amc.ktx2", "--unlit", "no.amc.ktx2", "--key", "0", "0"], "(?i)no such file", id="no such table"
        ),
        pytest.param(
            ["x.amc.ktx2", "--unlit", "x.unlit.amc.ktx2", "--key", "0", "0", "--add", "x.high.amc.ktx2"],
            "pairs of their own",
            id="two pairs",
        ),
        pytest.param(
            ["x.amc.ktx2", "--add", "x.high.amc.ktx2", "--coordinates", "vertex"],
            "for one table",
            id="a pair at vertices",
        ),
        pytest.param(["x.amc.ktx2", "--beside", "no.png"], "(?i)no such file", id="nothing beside it"),
        pytest.param(["wide.png"], "6 × 4 pixels are no MatCap", id="a MatCap that is not square"),
        pytest.param(["x.png", "--light", "0", "0"], "a MatCap has its light in it", id="a light for a MatCap"),
        pytest.param(["x.png", "--turn", "9"], "a MatCap has no grain", id="a turned MatCap"),
        pytest.param(["x.png", "--add", "x.high.amc.ktx2"], "a MatCap has no tables", id="a table added to a MatCap"),
        pytest.param(["coin.ptm", "--mesh", "torus", "--key", "0", "0"], "a PTM has no tables", id="a key for a PTM"),
        pytest.param(["coin.ptm", "--key", "0", "0"], "a PTM has no tables", id="a key for a flat PTM"),
    ],
)
def test_what_does_not_go_together_is_one_clear_error(
    files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], reason: str
) -> None:
    monkeypatch.chdir(files)
    with pytest.raises(InputError, match=reason) as caught:
        run(*arguments, "-o", tmp_path / "x.png", *([] if arguments == ["coin.ptm", "--key", "0", "0"] else SMALL))
    assert "\n" not in str(caught.value)
    assert not any(tmp_path.iterdir())


def test_ambient_occlusion_of_the_mesh_darkens(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("viewer.render_file.mesh_of", lambda _name: (with_occlusion(torus(48, 24)), ()))
    for name in ("x.amc.ktx2", "x.amc.exr", "x.png"):
        dark, bright = (draw(files, tmp_path / "x.png", name, *option) for option in (["--occlusion"], []))
        assert apart(dark, bright) > 20
        assert np.all(dark <= bright)
