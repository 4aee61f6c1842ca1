"""OBJ as it is found: indices of every kind, polygons, and lines that make no sense."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.errors import FormatError, InputError
from processing.mesh.files import obj
from processing.mesh.files.obj import read_obj

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
LAID = TRIANGLE + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n"


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "x.obj"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


@pytest.mark.parametrize(
    ("face", "has_uvs", "has_normals"),
    [
        ("f 1 2 3", False, False),
        ("f 1/1 2/2 3/3", True, False),
        ("f 1//1 2//1 3//1", False, True),
        ("f 1/1/1 2/2/1 3/3/1", True, True),
        ("f\t-3/-3/-1  -2/-2/-1 -1/-1/-1  # the same", True, True),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_every_way_to_write_a_face(tmp_path: Path, face: str, has_uvs: bool, has_normals: bool) -> None:
    (piece,) = read_obj(written(tmp_path, LAID + face))
    np.testing.assert_array_equal(piece.positions[piece.triangles[0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert (piece.uvs is not None, piece.normals is not None) == (has_uvs, has_normals)
    if piece.uvs is not None and piece.uv_triangles is not None:
        np.testing.assert_array_equal(piece.uvs[piece.uv_triangles[0]], [[0, 0], [1, 0], [0, 1]])
    if piece.normals is not None and piece.normal_triangles is not None:
        np.testing.assert_array_equal(piece.normals[piece.normal_triangles[0]], [[0, 0, 1]] * 3)


def test_negative_indices_count_back_from_their_line(tmp_path: Path) -> None:
    """Not from the end of the file."""
    further = "v 5 0 0\nv 6 0 0\nv 5 1 0\n"
    (piece,) = read_obj(written(tmp_path, f"{TRIANGLE}f -3 -2 -1\n{further}f -3 -2 -1\n"))
    np.testing.assert_array_equal(piece.triangles, [[0, 1, 2], [3, 4, 5]])


def test_polygons_are_cut_into_fans_and_kinds_of_faces_may_mix(tmp_path: Path) -> None:
    text = LAID + "v 1 1 0\nv 2 2 0\nf 1 2 4 3\nf 1 2 5 4 3\nf 1/1 2/2 3/3\n"
    square, five, laid = read_obj(written(tmp_path, text))
    np.testing.assert_array_equal(square.triangles, [[0, 1, 3], [0, 3, 2]])
    np.testing.assert_array_equal(five.triangles, [[0, 1, 4], [0, 4, 3], [0, 3, 2]])
    assert square.uvs is None and laid.uvs is not None


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(TRIANGLE.replace("\n", "\r\n") + "f 1 2 3\r\n", id="Windows"),
        pytest.param(TRIANGLE.replace("\n", "\r") + "f 1 2 3", id="old Macintosh"),
        pytest.param("\n".join([TRIANGLE, "f 1 \\", "2 \\", "3", ""]), id="continued line"),
        pytest.param(TRIANGLE.replace("0\n", "0 1\n", 1) + "f 1 2 3\n", id="a weight at one of them"),
        pytest.param("# café\nmtllib ../../secret.mtl\no x\ng y\ns off\n" + TRIANGLE + "usemtl a\nf 1 2 3", id="words"),
        pytest.param(b"# \xff\xfe\n" + TRIANGLE.encode() + b"f 1 2 3", id="no UTF-8"),
    ],
)
def test_dialects(tmp_path: Path, text: str | bytes) -> None:
    (piece,) = read_obj(written(tmp_path, text))
    np.testing.assert_array_equal(piece.positions[piece.triangles[0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        pytest.param("", "holds no faces", id="empty"),
        pytest.param(TRIANGLE, "holds no faces", id="points"),
        pytest.param("To whom it may concern:\nfindings\nvery good\n", "holds no faces", id="a letter"),
        pytest.param(TRIANGLE + "f 1 2 9\n", "line 4 names a v that is not among the file's 3", id="beyond"),
        pytest.param(TRIANGLE + "f 0 1 2\n", "line 4 names a v", id="index 0"),
        pytest.param(TRIANGLE + "f -4 1 2\n", "line 4 names a v", id="back beyond the first"),
        pytest.param(LAID + "f 1/1 2/2 3/9\n", "line 8 names a vt that is not among the file's 3", id="coordinates"),
        pytest.param(LAID + "f 1//1 2//2 3//1\n", "line 8 names a vn that is not among the file's 1", id="normals"),
        pytest.param(TRIANGLE + "f 1 2 99999999999999999999999\n", "line 4 names a v", id="a number past all"),
        pytest.param(TRIANGLE + "f 1 2\n", "line 4 is no face", id="two corners"),
        pytest.param(TRIANGLE + "f 1 2 3/1\n", "line 4 is no face", id="mixed corners"),
        pytest.param(LAID + "f 1/1 2/2 3/3\nf 1/ 2/ 3/\n", "line 9 is no face", id="left out"),
        pytest.param(TRIANGLE + "f 1 2 3\nf a b c\n", r"line 5 is no face \('a b c'\)", id="letters"),
        pytest.param(TRIANGLE + "f 1 2 2.5\n", "line 4 is no face", id="half an index"),
        pytest.param("v 0 0\nf 1 1 1\n", "line 1 has no 3 numbers", id="two numbers"),
        pytest.param(TRIANGLE + "v 1 x 3\nf 1 2 3\n", r"line 4 holds no numbers \('1 x 3'\)", id="no number"),
        pytest.param(TRIANGLE + "v 1 2 \x1b[2J\nf 1 2 3\n", r"line 4 holds no numbers \('1 2 \?\[2J'\)", id="escapes"),
    ],
)
def test_what_makes_no_sense_is_named_by_its_line(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(FormatError, match=reason) as caught:
        read_obj(written(tmp_path, text))
    assert str(caught.value).startswith(f"{tmp_path}/x.obj: ") and "\n" not in str(caught.value)


def test_more_triangles_than_allowed_are_counted_before_they_are_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(obj, "MOST_TRIANGLES", 3)
    with pytest.raises(FormatError, match="has 4 triangles, 3 are the most"):
        read_obj(written(tmp_path, TRIANGLE + "f 1 2 3 1 2 3\n"))
    with pytest.raises(FormatError, match="has more than 3 faces"):
        read_obj(written(tmp_path, TRIANGLE + "f 1 2 3\n" * 4))


@pytest.mark.parametrize(
    ("limit", "value", "reason"), [("MOST_LINES", 5, "more than 5 lines"), ("_LONGEST", 9, "line 5 has")]
)
def test_hostile_files_are_refused_before_they_grow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, value: int, reason: str
) -> None:
    monkeypatch.setattr(obj, limit, value)
    with pytest.raises(FormatError, match=reason):
        read_obj(written(tmp_path, TRIANGLE + "f 1 2 3\n" + "f 1 2 3 1 2 3\nf 1 2 3\n"))


@given(st.binary(max_size=200))
def test_noise_is_an_error_and_never_a_traceback(tmp_path_factory: pytest.TempPathFactory, noise: bytes) -> None:
    path = written(tmp_path_factory.getbasetemp(), TRIANGLE.encode() + noise)
    try:
        assert read_obj(path)
    except InputError as error:
        assert "\n" not in str(error)
