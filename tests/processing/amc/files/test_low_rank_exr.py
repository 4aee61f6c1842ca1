"""Low-rank AMC files: what is in them by the format's own description, and no lie believed."""

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.errors import FormatError, InputError
from processing.amc.files.low_rank_exr import read_low_rank, write_low_rank
from processing.amc.low_rank import LowRankAmc, compress
from tests.processing.amc.files.exr_by_the_book import read_exr
from tests.processing.amc.test_low_rank import some_amc

Parts = list[OpenEXR.Part]


def some_low(rank: int = 3, depth: int = 7, size: int = 21, seed: int = 0) -> LowRankAmc:
    return compress(some_amc(depth, size, seed), rank)


def test_an_independent_reader_finds_every_part(tmp_path: Path) -> None:
    low = some_low()
    write_low_rank(tmp_path / "x.amc.exr", low)
    parts = read_exr(tmp_path / "x.amc.exr")
    assert [part.text("name") for part in parts] == ["picture.0", "picture.1", "picture.2", "curves", "valid"]
    assert {part.text("litrig.kind") for part in parts} == {"amc-low-rank"}
    assert {part.text("type") for part in parts} == {"scanlineimage"}
    assert {part.window("displayWindow") for part in parts} == {(0, 0, 20, 20)}
    assert [part.window("dataWindow") for part in parts[2:]] == [(0, 0, 20, 20), (0, 0, 2, 6), (0, 0, 20, 20)]
    for part, picture in zip(parts, low.pictures, strict=False):
        stored = np.stack([part.channels[name] for name in "RGB"], axis=-1)
        assert stored.dtype == np.float32
        np.testing.assert_array_equal(stored, picture)
    np.testing.assert_array_equal(parts[3].channels["Y"], low.curves)
    np.testing.assert_array_equal(parts[4].channels["Y"], low.valid)


def test_every_part_says_what_the_table_means(tmp_path: Path) -> None:
    write_low_rank(tmp_path / "x.amc.exr", some_low())
    for part in read_exr(tmp_path / "x.amc.exr"):
        meaning = json.loads(part.text("litrig.amc"))
        assert meaning.pop("litrig")
        assert meaning == {
            "invariance": 3,
            "table_normal": "view",
            "slice_angles_deg": [1.0, 2.5],
            "source": "sha256:0a",
            "tangent_angle": "surface",
        }


@given(rank=st.integers(1, 4), more=st.integers(0, 20), size=st.integers(3, 20), seed=st.integers(0, 99))
def test_floats_come_back_bit_by_bit(
    tmp_path_factory: pytest.TempPathFactory, rank: int, more: int, size: int, seed: int
) -> None:
    path = tmp_path_factory.mktemp("low") / "x.amc.exr"
    low = some_low(rank, rank + more, size, seed)
    write_low_rank(path, low)
    assert_equal(read_low_rank(path), low)


def test_reading_and_writing_again_changes_nothing(tmp_path: Path) -> None:
    write_low_rank(tmp_path / "a.amc.exr", some_low())
    write_low_rank(tmp_path / "b.amc.exr", read_low_rank(tmp_path / "a.amc.exr"))
    assert (tmp_path / "a.amc.exr").read_bytes() == (tmp_path / "b.amc.exr").read_bytes()


def test_the_file_says_who_wrote_it_not_who_read_it(tmp_path: Path) -> None:
    low = some_low()
    older = dataclasses.replace(low, meaning=low.meaning.model_copy(update={"litrig": "0.0.1"}))
    write_low_rank(tmp_path / "x.amc.exr", older)
    assert read_low_rank(tmp_path / "x.amc.exr").meaning == low.meaning


def assert_equal(found: LowRankAmc, expected: LowRankAmc) -> None:
    for name in ("pictures", "curves", "valid"):
        values, truth = getattr(found, name), getattr(expected, name)
        assert values.dtype == truth.dtype
        np.testing.assert_array_equal(values, truth)
    assert found.meaning == expected.meaning


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        pytest.param({"pictures": np.zeros((3, 5, 4, 3), np.float32)}, "no low-rank AMC", id="not square"),
        pytest.param({"pictures": np.zeros((2, 5, 5, 3), np.float32)}, "no low-rank AMC", id="a picture short"),
        pytest.param({"pictures": np.zeros((0, 5, 5, 3), np.float32)}, "no low-rank AMC", id="no picture"),
        pytest.param({"valid": np.ones((4, 4), bool)}, "no low-rank AMC", id="validity of another size"),
        pytest.param({"curves": np.zeros(3, np.float32)}, "no low-rank AMC", id="one number for a curve"),
        pytest.param({"curves": np.full((7, 3), np.nan, np.float32)}, "no number", id="curves without numbers"),
        pytest.param({"pictures": np.full((3, 5, 5, 3), np.inf, np.float32)}, "no number", id="without end"),
    ],
)
def test_arrays_that_make_no_table_are_refused(tmp_path: Path, changes: dict[str, Any], reason: str) -> None:
    low = dataclasses.replace(some_low(size=5), **changes)
    with pytest.raises(InputError, match=reason):
        write_low_rank(tmp_path / "x.amc.exr", low)
    assert list(tmp_path.iterdir()) == []


def test_another_ending_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"end the name in \.amc\.exr"):
        write_low_rank(tmp_path / "x.amc.ktx2", some_low())


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist; create it"):
        write_low_rank(tmp_path / "nowhere" / "x.amc.exr", some_low())


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no\.amc\.exr: no such file"):
        read_low_rank(tmp_path / "no.amc.exr")


def part(name: str, channels: dict[str, Any], **header: Any) -> OpenEXR.Part:
    last = np.array([4, 4], np.int32)
    meaning = '{"invariance": 1, "table_normal": "view", "litrig": "1"}'
    base = {
        "name": name,
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "displayWindow": (np.zeros(2, np.int32), last),
        "litrig.kind": "amc-low-rank",
        "litrig.amc": meaning,
    }
    return OpenEXR.Part({**base, **header}, channels)


def picture(number: int, **header: Any) -> OpenEXR.Part:
    return part(f"picture.{number}", {"RGB": np.ones((5, 5, 3), np.float32)}, **header)


def curves(depth: int = 4, rank: int = 1, value: float = 1, **header: Any) -> OpenEXR.Part:
    return part("curves", {"Y": np.full((depth, rank), value, np.float32)}, **header)


def valid(value: float = 1, size: int = 5, **header: Any) -> OpenEXR.Part:
    return part("valid", {"Y": np.full((size, size), value, np.float32)}, **header)


def test_the_parts_of_these_tests_make_a_table(tmp_path: Path) -> None:
    """So that each of the next is refused for its one fault."""
    OpenEXR.File([picture(0), curves(), valid()]).write(str(tmp_path / "x.amc.exr"))
    np.testing.assert_array_equal(read_low_rank(tmp_path / "x.amc.exr").expand().slices, 1)


def test_half_floats_that_others_wrote_are_read(tmp_path: Path) -> None:
    halves = part("picture.0", {"RGB": np.full((5, 5, 3), 0.25, np.float16)})
    OpenEXR.File([halves, curves(), valid()]).write(str(tmp_path / "x.amc.exr"))
    np.testing.assert_array_equal(read_low_rank(tmp_path / "x.amc.exr").expand().slices, 0.25)


SHIFTED = (np.array([1, 0], np.int32), np.array([5, 4], np.int32))
ISOTROPIC = '{"invariance": "isotropic", "table_normal": "view", "litrig": "1"}'


@pytest.mark.parametrize(
    ("parts", "reason"),
    [
        pytest.param(lambda: [picture(0), valid()], "has parts picture.0, valid", id="no curves"),
        pytest.param(lambda: [curves(), valid()], "has parts curves, valid", id="no picture"),
        pytest.param(lambda: [picture(1), curves(), valid()], "has parts picture.1", id="a picture missing"),
        pytest.param(lambda: [curves(), picture(0), valid()], "has parts curves", id="another order"),
        pytest.param(lambda: [picture(0, **{"litrig.kind": "picture"}), curves(), valid()], "of kind", id="kind"),
        pytest.param(lambda: [picture(0, **{"litrig.amc": "{}"}), curves(), valid()], "invariance", id="no meaning"),
        pytest.param(
            lambda: [picture(0, **{"litrig.amc": ISOTROPIC}), curves(), valid()], "4 slices", id="contradiction"
        ),
        pytest.param(lambda: [picture(0), curves(rank=2), valid()], "with 2 curves", id="a curve too many"),
        pytest.param(
            lambda: [picture(0), picture(1), curves(1, 2), valid()], "over 1 slices", id="more curves than slices"
        ),
        pytest.param(lambda: [picture(0), curves(), valid(size=4)], "part valid is not 5 × 5", id="validity too small"),
        pytest.param(
            lambda: [part("picture.0", {"RGB": np.ones((5, 4, 3), np.float32)}), curves(), valid()],
            "1 pictures of 4 × 5",
            id="not square",
        ),
        pytest.param(
            lambda: [part("picture.0", {"RGBA": np.ones((5, 5, 4), np.float32)}), curves(), valid()],
            "has channels A, B, G, R",
            id="alpha",
        ),
        pytest.param(
            lambda: [part("picture.0", {"RGB": np.ones((5, 5, 3), np.uint32)}), curves(), valid()],
            "holds uint32",
            id="integers",
        ),
        pytest.param(lambda: [picture(0, displayWindow=SHIFTED), *_with(SHIFTED)], "display window", id="shifted"),
        pytest.param(lambda: [picture(0), curves(value=np.nan), valid()], "curves holds values that", id="no numbers"),
        pytest.param(lambda: [picture(0), curves(value=np.inf), valid()], "curves holds values that", id="infinite"),
        pytest.param(lambda: [picture(0), curves(), valid(0.5)], "other values than 0 and 1", id="half valid"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path: Path, parts: Callable[[], Parts], reason: str) -> None:
    path = tmp_path / "x.amc.exr"
    OpenEXR.File(parts()).write(str(path))
    with pytest.raises(FormatError, match=reason) as caught:
        read_low_rank(path)
    assert str(path) in str(caught.value)


def _with(window: Any) -> Parts:
    return [curves(displayWindow=window), valid(displayWindow=window)]


def test_a_picture_of_another_kind_is_refused(tmp_path: Path) -> None:
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    OpenEXR.File(header, {"RGB": np.ones((5, 5, 3), np.float32)}).write(str(tmp_path / "x.amc.exr"))
    with pytest.raises(FormatError, match="is of kind none, not amc-low-rank"):
        read_low_rank(tmp_path / "x.amc.exr")


def test_a_bomb_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    """Black packs a thousandfold: the size that the head claims is held against the length of the file."""
    path = tmp_path / "x.amc.exr"
    side = 1600
    window = (np.zeros(2, np.int32), np.array([side - 1, side - 1], np.int32))
    black = [part(f"picture.{n}", {"RGB": np.zeros((side, side, 3), np.float16)}, displayWindow=window) for n in (0, 1)]
    OpenEXR.File(
        [*black, curves(4, 2, displayWindow=window), valid(size=side, displayWindow=window)],
    ).write(str(path))
    with pytest.raises(FormatError, match="more than 200 to 1; refused"):
        read_low_rank(path)


@given(share=st.floats(0, 1, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(tmp_path_factory: pytest.TempPathFactory, share: float) -> None:
    path = tmp_path_factory.mktemp("low") / "x.amc.exr"
    write_low_rank(path, some_low(size=9))
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FormatError, match=r"x\.amc\.exr: .*(damaged|no EXR)"):
        read_low_rank(path)


@given(at=st.integers(0, 100_000), value=st.integers(0, 255))
def test_one_wrong_byte_is_an_error_or_a_table(tmp_path_factory: pytest.TempPathFactory, at: int, value: int) -> None:
    path = tmp_path_factory.mktemp("low") / "x.amc.exr"
    write_low_rank(path, some_low(size=9))
    content = bytearray(path.read_bytes())
    content[at % len(content)] = value
    path.write_bytes(content)
    try:
        low = read_low_rank(path)
    except FormatError:
        return
    assert low.pictures.nbytes < 1 << 20
