"""All forms together: what a way through any of them costs, which basis it holds, and that no bytes break a reader."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM, TERMS, Basis
from processing.ptm.files.coder import coder_for
from processing.ptm.files.either import describe, read_any, write_any
from processing.ptm.model import Colour, Material, Ptm, Space, Strip
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.files.fitted import LIGHTS, black, fitted, psnr_db, small
from tests.processing.ptm.files.jpeg_ptm import packed_ptm

FIRST, HSH4, HSH9 = Basis("ptm", 3), Basis("hsh", 4), Basis("hsh", 9)
EVERY_BASIS = [Basis(kind, terms) for kind, counts in TERMS.items() for terms in counts]
HELD = {
    "x.ptm": [PTM],
    "x.rti": [HSH4, HSH9],
    "x": [PTM, Basis("ptm", 3), HSH4, HSH9],
    "x.ptm.exr": EVERY_BASIS,
}
WAYS = [(name, basis) for name, bases in HELD.items() for basis in bases]


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize(("name", "basis"), WAYS, ids=str)
def test_no_form_costs_a_tenth_of_a_decibel(tmp_path: Path, name: str, basis: Basis, colour: Colour) -> None:
    material = fitted(basis, colour)
    write_any(tmp_path / name, material)
    again = read_any(tmp_path / name)
    assert again.basis == basis
    assert again.source == material.source
    assert psnr_db(again) > psnr_db(material) - 0.1


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize(("name", "basis"), WAYS, ids=str)
def test_what_was_black_in_every_picture_stays_black(tmp_path: Path, name: str, basis: Basis, colour: Colour) -> None:
    write_any(tmp_path / name, black(basis, colour))
    for light in LIGHTS[:4]:
        assert relight(read_any(tmp_path / name), light) == pytest.approx(np.zeros((8, 9, 3)), abs=1e-6)


def test_a_polynomial_of_first_degree_is_filled_up_in_a_ptm(tmp_path: Path) -> None:
    material = small(FIRST, "rgb")
    write_any(tmp_path / "x.ptm", material)
    again = read_any(tmp_path / "x.ptm")
    assert again.basis == PTM
    assert again.coefficients[:3] == pytest.approx(0)
    assert again.coefficients[3:] == pytest.approx(material.coefficients, abs=0.03)


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("basis", EVERY_BASIS, ids=str)
def test_a_basis_that_a_form_cannot_hold_is_refused_with_those_that_can(
    tmp_path: Path, name: str, basis: Basis
) -> None:
    if (name, basis) == ("x.ptm", FIRST):
        return  # filled up, as above
    if basis in HELD[name]:
        write_any(tmp_path / name, small(basis, "rgb"))
        assert describe(tmp_path / name)["basis"] == str(basis)
        return
    with pytest.raises(InputError, match=rf"{name}: .* not {basis}; end the name in \.ptm\.exr"):
        write_any(tmp_path / name, small(basis, "rgb"))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        pytest.param("x.png", r"cannot be written as \.png; end the name in", id="a picture"),
        pytest.param("no/x.ptm", r"the folder .* does not exist", id="no folder for the file"),
        pytest.param("no/x", r"the folder .* does not exist", id="no folder for the folder"),
        pytest.param("x" * 300, "File name too long", id="a name too long"),
    ],
)
def test_a_place_where_nothing_can_be_written_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        write_any(tmp_path / name, small(PTM, "rgb"))
    assert not list(tmp_path.iterdir())


def test_quality_is_for_folders(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="leave the quality out"):
        write_any(tmp_path / "x.ptm", small(PTM, "rgb"), quality=90)
    write_any(tmp_path / "x", small(PTM, "rgb"), quality=90)
    assert read_any(tmp_path / "x" / "info.json").basis == PTM


@pytest.mark.parametrize("name", ["x.png", "x.PTM2", "y" * 300])
def test_what_is_of_no_form_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=name):
        read_any(tmp_path / name)


@dataclass(frozen=True)
class RowByRow:
    """A material that is never held whole."""

    whole: Ptm

    @property
    def shape(self) -> tuple[int, int]:
        return self.whole.shape

    @property
    def kind(self) -> Colour:
        return self.whole.kind

    @property
    def space(self) -> Space:
        return self.whole.space

    @property
    def source(self) -> str:
        return self.whole.source

    @property
    def basis(self) -> Basis:
        return self.whole.basis

    @property
    def gram(self) -> NDArray[np.float64]:
        return self.whole.gram

    def strip(self, rows: slice) -> Strip:
        assert rows.stop - rows.start < self.shape[0], "asked for all rows at once"
        return self.whole.strip(rows)

    def sample(self, count: int) -> Strip:
        return self.whole.sample(count)


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize(("name", "basis"), [("x", PTM), ("x.rti", HSH4), ("x.ptm.exr", HSH4)], ids=str)
def test_a_material_is_written_strip_by_strip(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, basis: Basis, colour: Colour
) -> None:
    whole = fitted(basis, colour)
    write_any(tmp_path / name, whole)
    monkeypatch.setattr("processing.ptm.files.coder._STRIP_PIXELS", 1000)
    (tmp_path / "strips").mkdir()
    material: Material = RowByRow(whole)
    write_any(tmp_path / "strips" / name, material)
    np.testing.assert_array_equal(
        read_any(tmp_path / "strips" / name).coefficients, read_any(tmp_path / name).coefficients
    )


@pytest.mark.parametrize("basis", [PTM, HSH9], ids=str)
@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
def test_every_bias_is_a_code(basis: Basis, colour: Colour) -> None:
    coder = coder_for(Path("x"), fitted(basis, colour))
    assert all(0 <= step.bias <= 255 for steps in coder.steps for step in steps)


def test_a_colour_below_zero_is_not_written(tmp_path: Path) -> None:
    material = small(PTM, "lrgb")
    assert material.colour is not None
    with pytest.raises(InputError, match="x: colours below 0"):
        write_any(tmp_path / "x", Ptm(material.coefficients, material.colour - 0.5))
    assert not list(tmp_path.iterdir())


@contextmanager
def _good_files() -> Iterator[dict[str, bytes]]:
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        write_any(place / "a.ptm", small(PTM, "lrgb"))
        write_any(place / "a.rti", small(HSH4, "rgb"))
        write_any(place / "a.ptm.exr", small(HSH4, "lrgb"))
        write_any(place / "a", small(PTM, "lrgb"))
        (place / "b.ptm").write_bytes(packed_ptm(np.arange(9 * 16, dtype=np.uint8).reshape(9, 4, 4)))
        yield {
            **{name: (place / name).read_bytes() for name in ("a.ptm", "a.rti", "a.ptm.exr", "b.ptm")},
            **{f"a/{file.name}": file.read_bytes() for file in (place / "a").iterdir()},
        }


with _good_files() as found:
    GOOD = found


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    name=st.sampled_from(sorted(GOOD)),
    edits=st.lists(st.tuples(st.floats(0, 1), st.sampled_from("=-+"), st.binary(min_size=1, max_size=12)), max_size=4),
    kept=st.one_of(st.just(1.0), st.floats(0, 1)),
)
def test_no_bytes_break_a_reader(name: str, edits: list[tuple[float, str, bytes]], kept: float) -> None:
    """A file with bytes changed, removed, added or cut off is a finite material, or an error that names it."""
    content = GOOD[name]
    for share, how, new in edits:
        place = int(share * len(content))
        rest = content[place:] if how == "+" else content[place + len(new) :]
        content = content[:place] + (b"" if how == "-" else new) + rest
    with tempfile.TemporaryDirectory() as folder:
        for other, good in GOOD.items():
            (Path(folder) / other).parent.mkdir(exist_ok=True)
            (Path(folder) / other).write_bytes(content[: int(kept * len(content))] if other == name else good)
        path = Path(folder) / name.split("/")[0]
        try:
            material = read_any(path)
            describe(path)
        except InputError as error:
            assert str(path) in str(error)
        else:
            assert np.all(np.isfinite(material.coefficients))


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(["x.ptm", "x.rti", "x.ptm.exr", "x/info.json"]), st.binary(max_size=300))
def test_no_noise_is_read(name: str, content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
        with pytest.raises(InputError, match=path.name):
            read_any(path)
