import struct
from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from processing.ptm.basis import PTM, Basis
from processing.ptm.files.rti_file import describe_rti, read_rti, write_rti
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.files.fitted import small
from tests.processing.ptm.files.plain_rti import plain_picture

HSH4, HSH9 = Basis("hsh", 4), Basis("hsh", 9)
SOME_LIGHTS = [(0.0, 0.0), (0.6, 0.3), (-0.2, 0.8), (-0.5, -0.5)]


@pytest.mark.parametrize("colour", ["lrgb", "rgb"])
@pytest.mark.parametrize("basis", [HSH4, HSH9], ids=str)
def test_another_reader_sees_the_same_pictures(tmp_path: Path, basis: Basis, colour: Colour) -> None:
    """To a third of a step of each term in the mean: coefficients up to 1 in eight bits."""
    lost = []
    material = small(basis, colour)
    write_rti(tmp_path / "x.rti", material)
    for light in SOME_LIGHTS:
        seen = plain_picture(tmp_path / "x.rti", *light)
        assert seen == pytest.approx(relight(read_rti(tmp_path / "x.rti"), np.array(light)), abs=1e-5)
        lost.append(seen - relight(material, np.array(light)))
    assert np.sqrt(np.mean(np.square(lost))) < 0.0025 * np.sqrt(basis.terms)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_basis_space_and_source_survive(tmp_path: Path, space: Space) -> None:
    write_rti(tmp_path / "x.rti", small(HSH9, "lrgb", space))
    again = read_rti(tmp_path / "x.rti")
    assert (again.basis, again.kind, again.space, again.source) == (HSH9, "rgb", space, "abc123")


def rti(header: str, scales: list[float], biases: list[float], codes: bytes) -> bytes:
    floats = struct.pack(f"<{len(scales) + len(biases)}f", *scales, *biases)
    return header.encode() + floats + codes


HEADER = "#HSH1.2\n3\n1 2 3\n4 2 1\n"
SCALES, BIASES = [255.0, 255.0, 510.0, 255.0], [0.0, -10.0, 0.0, 1.0]
CODES = bytes(range(12)) + bytes(range(100, 112))
FILE = rti(HEADER, SCALES, BIASES, CODES)


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(FILE, id="relight's line ends"),
        pytest.param(rti(HEADER.replace("\n", "\r\n"), SCALES, BIASES, CODES), id="hshfitter's line ends"),
        pytest.param(rti(HEADER.replace("3\n", "# made by hand\n3\n", 1), SCALES, BIASES, CODES), id="a comment"),
        pytest.param(rti(HEADER.replace("4 2 1", " 4  2 1 "), SCALES, BIASES, CODES), id="blanks"),
        pytest.param(FILE + b"\n", id="a byte to spare"),
    ],
)
def test_what_others_write_is_read(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "x.rti").write_bytes(content)
    material = read_rti(tmp_path / "x.rti")
    assert material.shape == (2, 1)
    assert material.coefficients[:, 0, 0, 0] == pytest.approx([0, 1 - 10, 4, 4])
    assert material.coefficients[:, 0, 0, 2] == pytest.approx([8, 9 - 10, 20, 12])
    assert material.coefficients[:, 1, 0, 1] == pytest.approx([104, 105 - 10, 212, 108])
    assert (material.space, material.source) == ("srgb", "")


def test_it_is_described_from_its_header(tmp_path: Path) -> None:
    (tmp_path / "x.rti").write_bytes(FILE)
    facts = describe_rti(tmp_path / "x.rti")
    assert (facts["width"], facts["height"], facts["basis"]) == (1, 2, "HSH of 4 terms")
    assert facts["coefficients"]["h1"] == (-10, 245)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        pytest.param(b"", "not an .rti", id="empty"),
        pytest.param(bytes(range(256)) * 40, "not an .rti", id="garbage"),
        pytest.param(b"#" * 5000, "not an .rti", id="a comment without end"),
        pytest.param(FILE.replace(b"3\n", b"2\n", 1), r"type 2, not of HSH \(3\)", id="spherical harmonics"),
        pytest.param(FILE.replace(b"4 2 1", b"16 2 1"), "HSH of 16 terms; 4 or 9 are read", id="16 terms"),
        pytest.param(FILE.replace(b"1 2 3", b"1 2 1"), "1 channels of type 2", id="one channel"),
        pytest.param(FILE.replace(b"4 2 1", b"4 2 4"), "4 bytes a code", id="four bytes a code"),
        pytest.param(FILE.replace(b"1 2 3", b"0 2 3"), "claims 0 × 2 pixels", id="no width"),
        pytest.param(FILE.replace(b"1 2 3", b"999999999 999999999 3"), "claims 999999999", id="a header of petabytes"),
        pytest.param(FILE.replace(b"1 2 3", b"20000 20000 3"), "want 4,800,000,000 bytes", id="gigabytes not there"),
        pytest.param(FILE[:30], "ends in its header", id="cut in the scales"),
        pytest.param(FILE[:-1], "want 24 bytes, the file has 23", id="a byte short"),
        pytest.param(FILE + bytes(9), "goes on after its last pixel", id="too long"),
        pytest.param(rti(HEADER, [np.nan] * 4, BIASES, CODES), "out of all range, or no number", id="not a number"),
        pytest.param(rti(HEADER, SCALES, [np.inf] * 4, CODES), "out of all range, or no number", id="without bound"),
        pytest.param(FILE + b"\n#litrig {", "line after the pixels is damaged", id="remarks cut short"),
        pytest.param(FILE + b'\n#litrig {"space": "lab", "source": ""}', "space 'lab'", id="an unknown space"),
        pytest.param(FILE + b"\n#litrig " + b"[" * 4000, "line after the pixels is damaged", id="remarks too deep"),
    ],
)
def test_a_malformed_file_is_named(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "bad.rti").write_bytes(content)
    with pytest.raises(FormatError, match=rf"bad\.rti: .*{reason}"):
        read_rti(tmp_path / "bad.rti")


@pytest.mark.parametrize("basis", [PTM, Basis("hsh", 16)], ids=str)
def test_a_basis_that_readers_do_not_know_is_not_written(tmp_path: Path, basis: Basis) -> None:
    with pytest.raises(InputError, match=rf"x\.rti: .* HSH of 4 and 9 terms, not {basis}; write a \.ptm\.exr"):
        write_rti(tmp_path / "x.rti", small(basis, "rgb"))
    assert not list(tmp_path.iterdir())


def test_coefficients_that_are_not_numbers_are_not_written(tmp_path: Path) -> None:
    material = small(HSH4, "rgb")
    broken = Ptm(np.where(material.coefficients > 0.9, np.nan, material.coefficients), None, basis=HSH4)
    with pytest.raises(InputError, match=r"x\.rti: coefficients that are not numbers"):
        write_rti(tmp_path / "x.rti", broken)
    assert not list(tmp_path.iterdir())
