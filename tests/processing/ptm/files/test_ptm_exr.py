import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest

from litrig.base.errors import FormatError, InputError
from processing.ptm.basis import PTM, TERMS, Basis
from processing.ptm.files.ptm_exr import describe_ptm_exr, read_ptm_exr, write_ptm_exr
from processing.ptm.model import Colour, Ptm, Space
from tests.processing.amc.files.exr_by_the_book import read_exr
from tests.processing.ptm.files.fitted import small

EVERY_BASIS = [Basis(kind, terms) for kind, counts in TERMS.items() for terms in counts]
Parts = list[OpenEXR.Part]


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize("basis", EVERY_BASIS, ids=str)
@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_every_bit_comes_back(tmp_path: Path, basis: Basis, colour: Colour, space: Space) -> None:
    material = small(basis, colour, space)
    write_ptm_exr(tmp_path / "x.ptm.exr", material)
    again = read_ptm_exr(tmp_path / "x.ptm.exr")
    np.testing.assert_array_equal(again.coefficients, material.coefficients)
    assert (again.basis, again.kind, again.space, again.source) == (basis, colour, space, "abc123")
    if material.colour is not None:
        assert again.colour is not None
        np.testing.assert_array_equal(again.colour, material.colour)


def test_an_independent_reader_finds_every_part(tmp_path: Path) -> None:
    material = small(PTM, "lrgb")
    write_ptm_exr(tmp_path / "x.ptm.exr", material)
    parts = read_exr(tmp_path / "x.ptm.exr")
    terms = ["term.u2", "term.v2", "term.uv", "term.u", "term.v", "term.1"]
    assert [part.text("name") for part in parts] == ["colour", *terms]
    assert {part.text("litrig.kind") for part in parts} == {"ptm"}
    assert {part.window("dataWindow") for part in parts} == {(0, 0, 4, 2)}
    assert {part.window("displayWindow") for part in parts} == {(0, 0, 4, 2)}
    np.testing.assert_array_equal(np.stack([parts[0].channels[name] for name in "RGB"], axis=-1), material.colour)
    for part, term in zip(parts[1:], material.coefficients, strict=True):
        np.testing.assert_array_equal(part.channels["Y"], term[..., 0])
        meaning = json.loads(part.text("litrig.ptm"))
        assert meaning.pop("litrig")
        wanted = {"basis": "ptm", "terms": 6, "colour": "lrgb", "space": "srgb", "source": "abc123"}
        assert meaning == wanted


def test_it_is_described_from_its_heads(tmp_path: Path) -> None:
    write_ptm_exr(tmp_path / "x.ptm.exr", small(Basis("hsh", 16), "rgb"))
    facts = describe_ptm_exr(tmp_path / "x.ptm.exr")
    assert facts["basis"] == "HSH of 16 terms"
    assert (facts["width"], facts["height"], facts["colour"], facts["space"]) == (5, 3, "rgb", "srgb")


def rewritten(path: Path, change: Callable[[Parts], Any]) -> Path:
    write_ptm_exr(path, small(PTM, "lrgb"))
    with OpenEXR.File(str(path)) as exr:
        parts = [OpenEXR.Part(dict(part.header), {n: c.pixels for n, c in part.channels.items()}) for part in exr.parts]
    change(parts)
    OpenEXR.File(parts).write(str(path))
    return path


def meaning(**changes: Any) -> Callable[[Parts], Any]:
    def change(parts: Parts) -> None:
        for part in parts:
            part.header["litrig.ptm"] = json.dumps({**json.loads(part.header["litrig.ptm"]), **changes})

    return change


def of_kind(kind: str) -> Callable[[Parts], Any]:
    def change(parts: Parts) -> None:
        for part in parts:
            part.header["litrig.kind"] = kind

    return change


def not_a_number(parts: Parts) -> None:
    parts[2].channels["Y"].pixels[1, 1] = np.nan


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        pytest.param(of_kind("amc-low-rank"), "is of kind amc-low-rank, not ptm", id="another kind"),
        pytest.param(lambda parts: parts.pop(), "has parts colour, .*; copy it", id="a term short"),
        pytest.param(lambda parts: parts.reverse(), "has parts term.1", id="the other way round"),
        pytest.param(meaning(terms=3), "has parts .*, not colour, term.u, ", id="another number of terms"),
        pytest.param(meaning(terms=7), "litrig.ptm says ptm of 7 terms, which is none", id="no number of terms"),
        pytest.param(meaning(basis="fourier"), "litrig.ptm basis: ", id="an unknown basis"),
        pytest.param(meaning(colour="rgb"), "has parts ", id="another colour"),
        pytest.param(meaning(space="lab"), "litrig.ptm space: ", id="an unknown space"),
        pytest.param(not_a_number, "part term.v2 holds values that are no numbers", id="not a number"),
    ],
)
def test_a_lie_in_the_heads_is_named(tmp_path: Path, change: Callable[[Parts], Any], reason: str) -> None:
    path = rewritten(tmp_path / "bad.ptm.exr", change)
    with pytest.raises(FormatError, match=rf"bad\.ptm\.exr: {reason}"):
        read_ptm_exr(path)


@pytest.mark.parametrize("share", [0.2, 0.9], ids=["in the heads", "in the pixels"])
def test_a_file_cut_short_is_named(tmp_path: Path, share: float) -> None:
    write_ptm_exr(tmp_path / "bad.ptm.exr", small(PTM, "rgb"))
    content = (tmp_path / "bad.ptm.exr").read_bytes()
    (tmp_path / "bad.ptm.exr").write_bytes(content[: int(len(content) * share)])
    with pytest.raises(FormatError, match=r"bad\.ptm\.exr: "):
        read_ptm_exr(tmp_path / "bad.ptm.exr")


def test_a_picture_is_no_material(tmp_path: Path) -> None:
    OpenEXR.File({}, {"RGB": np.zeros((4, 4, 3), np.float32)}).write(str(tmp_path / "x.ptm.exr"))
    with pytest.raises(FormatError, match=r"x\.ptm\.exr: is of kind none, not ptm"):
        read_ptm_exr(tmp_path / "x.ptm.exr")


def test_coefficients_that_are_not_numbers_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x\.ptm\.exr: coefficients that are not numbers"):
        write_ptm_exr(tmp_path / "x.ptm.exr", Ptm(np.full((6, 2, 2, 3), np.nan, np.float32), None))
    assert not list(tmp_path.iterdir())
