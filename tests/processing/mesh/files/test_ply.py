"""PLY and STL as they are found."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.errors import FormatError, InputError
from processing.mesh.files import ply as module
from processing.mesh.files.ply import read_ply, read_stl
from tests.processing.mesh.files.scenes import HALVES, NORMALS, SQUARE, UVS, ply, stl


@pytest.mark.parametrize("ascii_", [True, False], ids=["ASCII", "binary"])
@pytest.mark.parametrize("names", [("s", "t"), ("u", "v"), ("texture_u", "texture_v")], ids=str)
def test_texture_coordinates_at_vertices(tmp_path: Path, ascii_: bool, names: tuple[str, str]) -> None:
    (piece,) = read_ply(ply(tmp_path, ascii_=ascii_, names=names))
    np.testing.assert_array_equal(piece.positions[piece.triangles], SQUARE[HALVES])
    assert piece.normals is not None and piece.normal_triangles is not None
    np.testing.assert_array_equal(piece.normals[piece.normal_triangles], NORMALS[HALVES])
    assert piece.uvs is not None and piece.uv_triangles is not None
    np.testing.assert_array_equal(piece.uvs[piece.uv_triangles], UVS[HALVES])


def test_texture_coordinates_at_corners(tmp_path: Path) -> None:
    text = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
end_header
0 0 0
1 0 0
1 1 0
0 1 0
3 0 1 2 6 0 0 1 0 1 1
3 0 2 3 6 5 5 6 6 5 6
"""
    (tmp_path / "x.ply").write_text(text)
    (piece,) = read_ply(tmp_path / "x.ply")
    assert piece.uvs is not None and piece.uv_triangles is not None
    np.testing.assert_array_equal(piece.uvs[piece.uv_triangles], [[[0, 0], [1, 0], [1, 1]], [[5, 5], [6, 6], [5, 6]]])


def test_a_scan_has_neither(tmp_path: Path) -> None:
    (piece,) = read_ply(ply(tmp_path, ascii_=False, names=None, normals=False))
    assert piece.uvs is None and piece.normals is None


@pytest.mark.parametrize("ascii_", [True, False], ids=["ASCII", "binary"])
def test_stl(tmp_path: Path, ascii_: bool) -> None:
    (tmp_path / "x.stl").write_bytes(stl(ascii_=ascii_))
    (piece,) = read_stl(tmp_path / "x.stl")
    np.testing.assert_array_equal(piece.positions[piece.triangles], SQUARE[HALVES])


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        pytest.param(b"element vertex 4", b"element vertex 9999999999999", "claims 9,999,999,999,999", id="terabytes"),
        pytest.param(b"element vertex 4", b"element vertex -4", "no number of elements", id="negative"),
        pytest.param(b"element vertex 4", b"element vertex 40", "is damaged or no PLY", id="ten times as many"),
        pytest.param(b"end_header", b"end of it", "its header does not end", id="no end"),
        pytest.param(b"element face 2", b"element face 0", "holds no faces|is damaged", id="points"),
        pytest.param(b"property float x", b"property float q", "is damaged or no PLY", id="no x"),
        pytest.param(b"property float x", b"property quad x", "is damaged or no PLY", id="no such type"),
        pytest.param(b"list uchar int", b"list double int", "is damaged or no PLY", id="half a list"),
        pytest.param(
            b"\x03\x00\x00\x00\x00\x01", b"\xff\x00\x00\x00\x00\x01", "is damaged or no PLY", id="a long list"
        ),
    ],
)
def test_a_ply_that_lies_is_one_clear_error(tmp_path: Path, old: bytes, new: bytes, reason: str) -> None:
    path = ply(tmp_path, ascii_=False)
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, 1))
    with pytest.raises(FormatError, match=reason) as caught:
        read_ply(path)
    assert str(caught.value).startswith(f"{path}: ") and "\n" not in str(caught.value)


def test_a_letter_in_ascii_is_an_error(tmp_path: Path) -> None:
    path = ply(tmp_path, ascii_=True)
    path.write_bytes(path.read_bytes().replace(b"1 1 0 0 0 1", b"1 x 0 0 0 1"))
    with pytest.raises(FormatError, match="is damaged or no PLY"):
        read_ply(path)


def test_hostile_text_is_refused_before_it_grows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_LINES", 12)
    with pytest.raises(FormatError, match="more than 12 lines"):
        read_ply(ply(tmp_path, ascii_=True))
    monkeypatch.setattr(module, "MOST_TRIANGLES", 1)
    (tmp_path / "x.stl").write_bytes(stl(ascii_=True))
    with pytest.raises(FormatError, match="more than 1 triangles"):
        read_stl(tmp_path / "x.stl")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is damaged or no STL|holds no faces"),
        (stl(ascii_=False)[:-7], "is damaged or no STL|holds no faces"),
        (b"\0" * 80 + b"\xff" * 4, "is damaged or no STL|holds no faces"),
        (stl(ascii_=True)[:120], "is damaged or no STL|holds no faces"),
        (b"\0" * 84, "holds no faces"),
    ],
    ids=["empty", "cut", "four milliards", "ASCII cut", "none"],
)
def test_a_broken_stl_is_one_clear_error(tmp_path: Path, content: bytes, reason: str) -> None:
    (tmp_path / "x.stl").write_bytes(content)
    with pytest.raises(FormatError, match=reason):
        read_stl(tmp_path / "x.stl")


@given(ascii_=st.booleans(), place=st.integers(0, 1000), noise=st.binary(min_size=1, max_size=4), cut=st.booleans())
def test_noise_is_an_error_and_never_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, ascii_: bool, place: int, noise: bytes, cut: bool
) -> None:
    path = ply(tmp_path_factory.getbasetemp(), ascii_=ascii_)
    content = path.read_bytes()
    at = place % len(content)
    path.write_bytes(content[:at] + noise + (b"" if cut else content[at + len(noise) :]))
    try:
        read_ply(path)
    except InputError as error:
        assert "\n" not in str(error)
