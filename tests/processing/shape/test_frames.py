from pathlib import Path

import pytest

from litrig.base.errors import InputError
from processing.shape.frames import frame, frame_numbers, is_pattern


def test_frames_that_are_there_are_found_in_order(tmp_path: Path) -> None:
    for name in ("shot.0010.exr", "shot.0002.exr", "shot.10000.exr", "shot.2.exr", "shot.00003.exr", "shot.0004.png"):
        (tmp_path / name).touch()
    pattern = tmp_path / "shot.####.exr"
    assert is_pattern(pattern) and not is_pattern(tmp_path / "shot.exr")
    assert frame_numbers(pattern) == [2, 10, 10000]
    assert [frame(pattern, number).name for number in (2, 10000)] == ["shot.0002.exr", "shot.10000.exr"]
    assert frame(tmp_path / "mask.png", 3) == tmp_path / "mask.png"


def test_patterns_without_frames_or_with_two_numbers_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such frame"):
        frame_numbers(tmp_path / "a.##.exr")
    with pytest.raises(InputError, match="2 places"):
        frame_numbers(tmp_path / "a#b#.exr")
    with pytest.raises(InputError, match="does not exist"):
        frame_numbers(tmp_path / "no" / "a#.exr")
