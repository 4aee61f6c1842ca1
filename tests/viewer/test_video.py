from pathlib import Path

import cv2
import numpy as np
import pytest

from litrig.base.errors import InputError
from viewer.video import write_video


def test_another_decoder_finds_the_frames(tmp_path: Path) -> None:
    frames = [np.full((48, 64, 3), 40 * index, np.uint8) for index in range(6)]
    write_video(tmp_path / "a.mp4", frames, fps=10)
    video = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(10)
    for expected in frames:
        good, found = video.read()
        assert good
        assert abs(float(found.mean()) - float(expected.mean())) < 6
    assert not video.read()[0]


@pytest.mark.parametrize(
    ("shapes", "message"),
    [
        pytest.param([], "no frames", id="nothing"),
        pytest.param([(47, 64, 3)], "even height", id="odd height"),
        pytest.param([(48, 64, 3), (48, 62, 3)], "one size", id="two sizes"),
    ],
)
def test_what_is_no_video_leaves_no_file(tmp_path: Path, shapes: list[tuple[int, ...]], message: str) -> None:
    with pytest.raises(InputError, match=message):
        write_video(tmp_path / "a.mp4", [np.zeros(shape, np.uint8) for shape in shapes])
    assert list(tmp_path.iterdir()) == []
