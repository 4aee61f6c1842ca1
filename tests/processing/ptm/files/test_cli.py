import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from litrig.base.pictures import read_codes
from processing.ptm.basis import PTM, Basis
from processing.ptm.cli import ptm
from processing.ptm.files.either import read_any, write_any
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.files.fitted import small

HSH4 = Basis("hsh", 4)


def run(*words: object) -> str:
    result = CliRunner().invoke(ptm, [str(word) for word in words], catch_exceptions=False)
    assert result.exit_code == 0
    return result.output


@pytest.mark.parametrize(
    ("names", "basis"),
    [(["x.ptm", "web", "y.ptm.exr", "z.ptm"], PTM), (["x.rti", "web", "y.ptm.exr", "z.rti"], HSH4)],
    ids=["PTM", "HSH"],
)
def test_a_material_goes_through_every_form(tmp_path: Path, names: list[str], basis: Basis) -> None:
    material = small(basis, "rgb")
    write_any(tmp_path / names[0], material)
    for source, target in pairwise(names):
        said = run("convert", tmp_path / source, tmp_path / target)
        assert said == f"{tmp_path / target}: 5 × 3 pixels, {basis}, srgb values\n"
    again = read_any(tmp_path / names[-1])
    assert again.coefficients == pytest.approx(material.coefficients, abs=0.05)
    assert again.source == material.source


def test_the_quality_of_a_web_folder_can_be_chosen(tmp_path: Path) -> None:
    write_any(tmp_path / "x.ptm", small(PTM, "rgb"))
    run("convert", tmp_path / "x.ptm", tmp_path / "web", "--quality", 93)
    assert json.loads((tmp_path / "web" / "info.json").read_text())["quality"] == 93


@pytest.mark.parametrize(
    ("name", "basis", "form"),
    [
        ("x.ptm", PTM, ".ptm"),
        ("x.rti", HSH4, ".rti"),
        ("x", HSH4, "a web folder"),
        ("x.ptm.exr", Basis("hsh", 16), ".ptm.exr"),
    ],
)
def test_info_tells_what_a_form_holds(tmp_path: Path, name: str, basis: Basis, form: str) -> None:
    write_any(tmp_path / name, small(basis, "rgb", "linear"))
    facts = json.loads(run("info", tmp_path / name, "--json"))
    assert (facts["form"], facts["width"], facts["height"], facts["basis"]) == (form, 5, 3, str(basis))
    assert (facts["colour"], facts["space"], facts["source"]) == ("rgb", "linear", "abc123")
    lines = run("info", tmp_path / name).splitlines()
    assert f"basis: {basis}" in lines
    if "coefficients" in facts:
        assert list(facts["coefficients"]) == list(basis.names)
        assert all(-1.1 < low <= 0 <= high < 1.1 for low, high in facts["coefficients"].values())
        assert lines[lines.index("coefficients:") + 1].startswith(f"  {basis.names[0]}: ")


@pytest.mark.parametrize("name", ["x.rti", "x", "x.ptm.exr"])
def test_every_form_is_relit(tmp_path: Path, name: str) -> None:
    write_any(tmp_path / name, small(HSH4, "rgb"))
    run("relight", tmp_path / name, "--light", 0.3, -0.4, "-o", tmp_path / "lit.png")
    values = relight(read_any(tmp_path / name), np.array([0.3, -0.4]))
    assert np.array_equal(read_codes(tmp_path / "lit.png"), np.rint(np.clip(values, 0, 1) * 255))
