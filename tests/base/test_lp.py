from pathlib import Path

import numpy as np
import pytest

from litrig.base.errors import FormatError, InputError
from litrig.base.lp import LightDirections, read_lp, write_lp


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"2\na 1.jpg 0 0 2\nb.jpg 0.6 0 0.8\n", id="plain, a name with a blank"),
        pytest.param(b"2\r\na 1.jpg 0 0 1\r\nb.jpg 0.6 0 0.8\r\n", id="Windows line ends"),
        pytest.param(b"a 1.jpg 0 0 1\nb.jpg 0.6 0 0.8", id="no count"),
        pytest.param(b"\xef\xbb\xbf2\na 1.jpg 0 0 1\nb.jpg 0,6 0 0,8\n", id="byte order mark and decimal commas"),
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
    lights = LightDirections(("a.jpg",), np.array([[0.36, 0.48, 0.8]]))
    write_lp(path, lights)
    assert path.read_text().splitlines()[0] == "1"
    np.testing.assert_allclose(read_lp(path).directions, lights.directions, atol=1e-6)
