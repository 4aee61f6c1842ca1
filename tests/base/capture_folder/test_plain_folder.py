from pathlib import Path

import numpy as np
import pytest

from litrig.base.capture_folder.reader import read_capture
from litrig.base.errors import FormatError, InputError
from litrig.base.pictures import write_codes


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "cat"
    folder.mkdir()
    for name in ("a.png", "b.png", "mask.png"):
        write_codes(folder / name, np.zeros((4, 4, 3), np.uint8))
    return folder


def test_lights_are_paired_by_name_not_by_order(folder: Path) -> None:
    (folder / "x.lp").write_text("2\nb.png 0 0 1\na.png 1 0 0\n")
    frames = read_capture(folder).frames
    assert [frame.path.name for frame in frames] == ["b.png", "a.png"]
    assert frames[1].light is not None
    np.testing.assert_allclose(frames[1].light, [1, 0, 0])


def test_angles_are_paired_by_name(folder: Path) -> None:
    (folder / "angles.csv").write_text("name,deg\nb.png,10.5\na.png,0\n")
    frames = read_capture(folder).frames
    assert [(frame.path.name, frame.angle_deg) for frame in frames] == [("b.png", 10.5), ("a.png", 0)]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        pytest.param("x.lp", "1\nc.png 0 0 1\n", r"x\.lp: names c\.png, not found in", id="missing picture"),
        pytest.param("angles.csv", "c.png,1\n", r"line 1: c\.png is not in the folder", id="missing slice"),
        pytest.param("angles.csv", "a.png,1\na.png,2\n", r"line 2: a\.png stands twice", id="slice twice"),
        pytest.param("angles.csv", "a.png;1\n", r"line 1: expected `name,deg`", id="wrong separator"),
    ],
)
def test_a_list_that_does_not_fit_names_the_culprit(folder: Path, name: str, text: str, message: str) -> None:
    (folder / name).write_text(text)
    with pytest.raises((InputError, FormatError), match=message):
        read_capture(folder)


def test_two_lists_are_one_too_many(folder: Path) -> None:
    (folder / "x.lp").write_text("1\na.png 0 0 1\n")
    (folder / "y.lp").write_text("1\na.png 0 0 1\n")
    with pytest.raises(InputError, match=r"x\.lp, y\.lp; keep one"):
        read_capture(folder)


def test_empty_and_missing_folders_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no picture"):
        read_capture(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        read_capture(tmp_path / "gone")
