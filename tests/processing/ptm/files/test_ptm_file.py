from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import FormatError, InputError
from processing.ptm.files.ptm_file import read_ptm, write_ptm
from processing.ptm.fit import fit
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.quality import fit_quality
from processing.ptm.relighting.relight import relight
from processing.stack import Stack
from tests.processing.ptm.files.plain_reader import plain_picture
from tests.processing.ptm.relief import dome, write_relief

LIGHTS = dome(24)
SOME_LIGHTS = [(0.0, 0.0), (0.6, 0.3), (-0.2, 0.8), (-0.5, -0.5)]


@pytest.fixture(scope="module")
def relief(tmp_path_factory: pytest.TempPathFactory) -> Stack:
    return Stack(write_relief(tmp_path_factory.mktemp("relief"), LIGHTS))


def small_ptm(colour: bool = True, space: Space = "srgb") -> Ptm:
    random = np.random.default_rng(8)
    coefficients = random.uniform(-1, 1, (6, 3, 5, 1 if colour else 3)).astype(np.float32)
    return Ptm(coefficients, random.uniform(0, 1, (3, 5, 3)).astype(np.float32) if colour else None, space, "abc123")


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
def test_another_reader_sees_the_same_pictures(colour: Colour, relief: Stack, tmp_path: Path) -> None:
    ptm = fit(relief, LIGHTS, colour=colour)
    write_ptm(tmp_path / "x.ptm", ptm)
    for light in SOME_LIGHTS:
        seen = plain_picture(tmp_path / "x.ptm", *light) / 255
        assert seen == pytest.approx(relight(read_ptm(tmp_path / "x.ptm"), np.array(light)), abs=1e-5)
        assert np.sqrt(np.mean((seen - relight(ptm, np.array(light))) ** 2)) < 0.015


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_eight_bits_cost_an_lrgb_ptm_at_most_a_tenth_of_a_decibel(space: Space, relief: Stack, tmp_path: Path) -> None:
    ptm = fit(relief, LIGHTS, space=space)
    write_ptm(tmp_path / "x.ptm", ptm)
    kept = fit_quality(read_ptm(tmp_path / "x.ptm"), relief, LIGHTS).psnr_db
    assert kept > fit_quality(ptm, relief, LIGHTS).psnr_db - 0.1


@pytest.mark.parametrize("colour", [True, False], ids=["lrgb", "rgb"])
def test_a_file_is_read_as_it_was_written(colour: bool, tmp_path: Path) -> None:
    """To half a step: coefficients up to 1 in 8 bits, and the colour's own 8 bits."""
    ptm = small_ptm(colour)
    write_ptm(tmp_path / "x.ptm", ptm)
    again = read_ptm(tmp_path / "x.ptm")
    written = ptm.coefficients if ptm.colour is None else ptm.coefficients * ptm.colour
    read = again.coefficients if again.colour is None else again.coefficients * again.colour
    assert read == pytest.approx(written, abs=0.012)
    assert (again.colour is None) == (ptm.colour is None)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_space_and_source_survive(space: Space, tmp_path: Path) -> None:
    write_ptm(tmp_path / "x.ptm", small_ptm(space=space))
    again = read_ptm(tmp_path / "x.ptm")
    assert (again.space, again.source) == (space, "abc123")


def test_a_ptm_that_is_black_all_over_is_finite(tmp_path: Path) -> None:
    write_ptm(tmp_path / "x.ptm", Ptm(np.zeros((6, 2, 2, 1), np.float32), np.ones((2, 2, 3), np.float32)))
    assert relight(read_ptm(tmp_path / "x.ptm"), np.array([0.3, 0.3])) == pytest.approx(np.zeros((2, 2, 3)))


def test_coefficients_that_are_not_numbers_are_not_written(tmp_path: Path) -> None:
    ptm = small_ptm()
    ptm.coefficients[2, 1, 1] = np.nan
    with pytest.raises(InputError, match=r"x\.ptm: coefficients that are not numbers"):
        write_ptm(tmp_path / "x.ptm", ptm)
    assert not list(tmp_path.iterdir())


# Two pixels wide, one high; the codes of a pixel are 1..6 and 11..16, colours 100, 150, 200 and 255, 0, 50.
CODES = [bytes(range(1, 7)), bytes(range(11, 17))]
COLOURS = [bytes([100, 150, 200]), bytes([255, 0, 50])]
BLOCKS = b"".join(CODES) + b"".join(COLOURS)
SCALES, BIASES = b"2 1 1 0.5 1 1", b"0 0 0 3 451 -286"


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n1\n" + SCALES + b"\n" + BIASES + b"\n" + BLOCKS, id="six lines"),
        pytest.param(
            b"PTM_1.2\nPTM_FORMAT_LRGB\n2 1\n" + SCALES + b"\n" + BIASES + b"\n" + BLOCKS, id="size on a line"
        ),
        pytest.param(
            b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n1\n" + SCALES + b" " + BIASES + b"\n" + BLOCKS, id="one line of 12"
        ),
        pytest.param(
            b"\nPTM_1.2\n\nPTM_FORMAT_LRGB\n\n2\n1\n\n" + SCALES + b" \n" + BIASES + b" \n" + BLOCKS,
            id="blanks all over",
        ),
        pytest.param(
            b"PTM_1.2\r\nPTM_FORMAT_LRGB\r\n2\r\n1\r\n" + SCALES + b"\r\n" + BIASES + b"\r\n" + BLOCKS, id="Windows"
        ),
        pytest.param(
            b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n1\n" + SCALES + b"\n" + BIASES + b"\n" + BLOCKS + b"\0", id="a byte to spare"
        ),
        pytest.param(
            b"PTM_1.1\nPTM_FORMAT_LRGB\n2\n1\n"
            + SCALES
            + b"\n"
            + BIASES
            + b"\n"
            + b"".join(code + colour for code, colour in zip(CODES, COLOURS, strict=True)),
            id="version 1.1: nine bytes a pixel",
        ),
    ],
)
def test_header_oddities_are_read(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "odd.ptm").write_bytes(content)
    ptm = read_ptm(tmp_path / "odd.ptm")
    assert ptm.colour is not None
    assert ptm.coefficients[:, 0, 0, 0] * 255 == pytest.approx([2, 2, 3, 0.5, 5 - 451, 6 + 286], rel=1e-5)
    assert ptm.coefficients[:, 0, 1, 0] * 255 == pytest.approx([22, 12, 13, 5.5, 15 - 451, 16 + 286], rel=1e-5)
    assert ptm.colour[0] * 255 == pytest.approx(np.array([[100, 150, 200], [255, 0, 50]]))
    assert (ptm.space, ptm.source) == ("srgb", "")


def test_rows_are_stored_from_the_bottom_up(tmp_path: Path) -> None:
    steps = b"1 1 1 1 1 1\n0 0 0 0 0 0\n"
    (tmp_path / "x.ptm").write_bytes(b"PTM_1.2\nPTM_FORMAT_RGB\n1\n2\n" + steps + bytes([0, 0, 0, 0, 0, 7] + [0] * 30))
    constant: NDArray[np.float32] = read_ptm(tmp_path / "x.ptm").coefficients[5] * 255
    assert constant[:, 0, 0] == pytest.approx([0, 7])


HEADER = b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n1\n" + SCALES + b"\n" + BIASES + b"\n"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        pytest.param(b"", "not a PTM file", id="empty"),
        pytest.param(bytes(range(256)) * 40, "not a PTM file", id="garbage"),
        pytest.param(b"PTM_1.2\nPTM_FORMAT_LRGB\n2\n1\n1 1 1", "header is damaged", id="header cut short"),
        pytest.param(HEADER.replace(b"0.5", b"nan") + BLOCKS, "header is damaged", id="a scale in words"),
        pytest.param(HEADER.replace(b"0.5", b"1.2.3") + BLOCKS, "scale is not a number", id="a scale of two points"),
        pytest.param(HEADER.replace(b"0.5", b"1e99") + BLOCKS, "out of all range", id="a scale beyond float32"),
        pytest.param(HEADER.replace(b"451", b"9" * 30) + BLOCKS, "out of all range", id="a bias of thirty digits"),
        pytest.param(HEADER.replace(b"1.2", b"1.3", 1) + BLOCKS, "not a PTM file", id="version 1.3"),
        pytest.param(HEADER + BLOCKS[:-1], "want 18 bytes, the file has 17", id="a byte short"),
        pytest.param(HEADER, "want 18 bytes, the file has 0", id="no pixels"),
        pytest.param(HEADER + BLOCKS + bytes(9), "goes on after its last pixel", id="too long"),
        pytest.param(
            HEADER.replace(b"\n2\n1\n", b"\n999999999\n999999999\n") + BLOCKS,
            "claims 999999999",
            id="a header of petabytes",
        ),
        pytest.param(
            HEADER.replace(b"\n2\n1\n", b"\n20000\n20000\n") + BLOCKS,
            "want 3,600,000,000 bytes",
            id="gigabytes not there",
        ),
        pytest.param(HEADER.replace(b"\n2\n1\n", b"\n0\n1\n"), "claims 0 × 1", id="no width"),
        pytest.param(
            HEADER.replace(b"LRGB", b"JPEGLS_LRGB") + BLOCKS, "JPEGLS_LRGB, which is not read", id="a JPEG-LS kind"
        ),
        pytest.param(HEADER + BLOCKS + b"\n#litrig {", "line after the pixels is damaged", id="remarks cut short"),
        pytest.param(
            HEADER + BLOCKS + b'\n#litrig {"space": "lab", "source": ""}', "space 'lab'", id="an unknown space"
        ),
    ],
)
def test_a_malformed_file_is_named(content: bytes, reason: str, tmp_path: Path) -> None:
    (tmp_path / "bad.ptm").write_bytes(content)
    with pytest.raises(FormatError, match=rf"bad\.ptm: .*{reason}"):
        read_ptm(tmp_path / "bad.ptm")


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.ptm: cannot be read"):
        read_ptm(tmp_path / "gone.ptm")
