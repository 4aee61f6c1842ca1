import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from litrig.base.errors import FormatError, InputError
from litrig.base.lights import Lights
from litrig.base.lp import read_lp, spellings, write_lp


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"2\na 1.jpg 0 0 2\nb.jpg 0.6 0 0.8\n", id="plain, a name with a blank"),
        pytest.param(b"2\r\na 1.jpg 0 0 1\r\nb.jpg 0.6 0 0.8\r\n", id="Windows line ends"),
        pytest.param(b"a 1.jpg 0 0 1\nb.jpg 0.6 0 0.8", id="no count"),
        pytest.param(b"\xef\xbb\xbf2\na 1.jpg 0 0 1\nb.jpg 0,6 0 0,8\n", id="byte order mark and decimal commas"),
        pytest.param(b"2\na 1.jpg\t0\t0\t1\nb.jpg\t0.6\t0\t0.8\n", id="tabs"),
        pytest.param(b"2\na 1.jpg;0;0;1\nb.jpg;0,6;0;0,8;\n", id="semicolons and decimal commas"),
        pytest.param(b"a 1.jpg, 0, 0, 1\nb.jpg,0.6,0,0.8\n", id="commas"),
        pytest.param(b'2\n"C:\\caps x\\a 1.jpg" 0 0 1\nb.jpg 0.6 0 0.8\n', id="a name in quotes"),
        pytest.param("2\na 1.jpg 0 0 1\nb.jpg 0.6 0 0.8\n".encode("utf-16"), id="UTF-16"),
        pytest.param(b"2\nC:\\caps x\\a 1.jpg 0 0 1\n\n..\\b.jpg 0.6 0 0.8\n", id="Windows paths and an empty line"),
    ],
)
def test_the_dialects_of_the_field(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.lp"
    path.write_bytes(content)
    lights = read_lp(path)
    assert lights.names == ("a 1.jpg", "b.jpg")
    np.testing.assert_allclose(lights.directions, np.array([[0, 0, 1], [0.6, 0, 0.8]]), atol=1e-12)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        pytest.param(b"", "empty", id="empty"),
        pytest.param(b"3\na 0 0 1\n", "promises 3 lights and has 1", id="wrong count"),
        pytest.param(b"1\na 0 0\n", "line 2: expected `name x y z`", id="two numbers"),
        pytest.param(b"1\na 0 0 0\n", "line 2: the direction of a has no length", id="zero vector"),
        pytest.param(b"1\na nan 0 1\n", "line 2: the direction of a has no length", id="not a number"),
        pytest.param(b"2\na 0 0 1\na 0 1 0\n", "names a twice", id="a name twice"),
        pytest.param(b"2\na.jpg 0 0 1\n0 1 0\n", "1 of 2 lines have no picture's name", id="a name forgotten"),
        pytest.param(b"2\n" + b" " * 3_000_000 + b"0\n", "promises 2 lights and has 1", id="blanks without end"),
        pytest.param(b"a" + b" 0" * 1_000_000 + b" x\n", "line 1: expected `name x y z`", id="a line without end"),
        pytest.param(b"0\n", "names no light", id="a count of nothing"),
        pytest.param(b"\xff\xd8\xff\xe0 picture", "line 1", id="a picture"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "x.lp"
    path.write_bytes(content)
    with pytest.raises(FormatError, match=f"x.lp.*{message}"):
        read_lp(path)


def test_a_device_is_not_read() -> None:
    with pytest.raises(InputError, match="/dev/zero: is a device or a pipe; name a file"):
        read_lp(Path("/dev/zero"))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.lp"):
        read_lp(tmp_path / "gone.lp")


def test_written_directions_come_back(tmp_path: Path) -> None:
    path = tmp_path / "x.lp"
    lights = Lights(("a.jpg",), np.array([[0.36, 0.48, 0.8]]))
    write_lp(path, lights)
    assert path.read_text().splitlines()[0] == "1"
    np.testing.assert_allclose(read_lp(path).directions, lights.directions, atol=1e-6)


def test_lines_without_names_are_lights_in_order(tmp_path: Path) -> None:
    (tmp_path / "x.lp").write_text("3\n0 0 1\n0,6 0 0,8\n0;1;0\n")
    lights = read_lp(tmp_path / "x.lp")
    assert lights.names is None
    assert lights.directions == pytest.approx(np.array([[0, 0, 1], [0.6, 0, 0.8], [0, 1, 0]]))


def test_lights_without_names_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x\.lp: .* give them some"):
        write_lp(tmp_path / "x.lp", Lights(None, np.array([[0.0, 0, 1]])))
    assert not list(tmp_path.iterdir())


def test_positions_are_kept_beside_their_directions(tmp_path: Path) -> None:
    (tmp_path / "x.lp").write_text("2\na.jpg 30 0 40\nb.jpg 0 0 1\n")
    lights = read_lp(tmp_path / "x.lp")
    assert lights.directions == pytest.approx(np.array([[0.6, 0, 0.8], [0, 0, 1]]))
    assert lights.vectors == pytest.approx(np.array([[30, 0, 40], [0, 0, 1]]))


def test_directions_to_three_digits_are_no_positions(tmp_path: Path) -> None:
    (tmp_path / "x.lp").write_text("1\na.jpg 0.577 0.577 0.577\n")
    lights = read_lp(tmp_path / "x.lp")
    assert lights.vectors is None
    assert np.linalg.norm(lights.directions[0]) == pytest.approx(1)


@pytest.mark.parametrize(("name", "code_page"), [("한글.jpg", "cp949"), ("写真.jpg", "cp932"), ("grün.jpg", "cp1252")])
def test_a_name_can_be_had_in_its_own_code_page(tmp_path: Path, name: str, code_page: str) -> None:
    (tmp_path / "x.lp").write_bytes(f"1\n{name} 0 0 1\n".encode(code_page))
    lights = read_lp(tmp_path / "x.lp")
    assert lights.names is not None
    assert name in spellings(lights.names[0])
    write_lp(tmp_path / "y.lp", lights)


@given(st.binary(max_size=200))
@example(b"1\n\x81\x8d 0 0 1")
def test_any_bytes_are_lights_or_an_error(content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.lp"
        path.write_bytes(content)
        try:
            lights = read_lp(path)
        except InputError as error:
            assert "x.lp" in str(error)
        else:
            assert np.linalg.norm(lights.directions, axis=1) == pytest.approx(np.ones(len(lights)))
