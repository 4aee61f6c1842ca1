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


def test_angles_are_read_as_old_windows_programs_write_them(folder: Path) -> None:
    (folder / "a.png").rename(folder / "grün.png")
    (folder / "angles.csv").write_bytes("grün.png,1\r\nb.png,2\r\n".encode("cp1252"))
    assert [(frame.path.name, frame.angle_deg) for frame in read_capture(folder).frames] == [
        ("grün.png", 1),
        ("b.png", 2),
    ]


def test_lights_and_angles_are_paired_both(folder: Path) -> None:
    (folder / "x.lp").write_text("2\nb.png 0 0 1\na.png 1 0 0\n")
    (folder / "angles.csv").write_text("a.png,30\nb.png,60\nmask.png,90\n")
    frames = read_capture(folder).frames
    assert [(frame.path.name, frame.angle_deg) for frame in frames] == [("b.png", 60), ("a.png", 30)]
    assert all(frame.light is not None for frame in frames)


def test_a_list_that_is_a_folder_is_refused(folder: Path) -> None:
    (folder / "angles.csv").mkdir()
    with pytest.raises(InputError, match=r"angles\.csv: is a folder; name a file"):
        read_capture(folder)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        pytest.param("x.lp", "1\nc.png 0 0 1\n", r"x\.lp: names c\.png, not found in", id="missing picture"),
        pytest.param("angles.csv", "c.png,1\n", r"line 1: c\.png is not in the folder", id="missing slice"),
        pytest.param("angles.csv", "a.png,1\na.png,2\n", r"line 2: a\.png stands twice", id="slice twice"),
        pytest.param("angles.csv", "a.png;1\n", r"line 1: expected `name,deg`", id="wrong separator"),
        pytest.param("angles.csv", "a.png,0\nb.png,nan\n", "line 2: .*nan is outside ±3600", id="no number"),
        pytest.param("angles.csv", "a.png,1e300\n", r"line 1: .*1e\+300 is outside ±3600", id="beyond all turns"),
        pytest.param("angles.csv", 'a.png,"' + "9" * 140_000, "expected `name,deg`", id="a field without end"),
        pytest.param("angles.csv", b"\xff\xd8\xff\xe0\0\x10JFIF", "expected `name,deg`", id="a picture"),
        pytest.param("x.lp", b"\xff\xd8\xff\xe0\0\x10JFIF", "expected `name x y z`", id="a picture for an .lp"),
    ],
)
def test_a_list_that_does_not_fit_names_the_culprit(folder: Path, name: str, text: str | bytes, message: str) -> None:
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
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
