import re
import subprocess
from pathlib import Path

import cv2
import imageio_ffmpeg
import numpy as np
import pytest

from litrig.base.errors import InputError
from viewer.video import write_video


def test_another_decoder_finds_the_frames(tmp_path: Path) -> None:
    frames = [np.full((48, 64, 3), 40 * index, np.uint8) for index in range(6)]
    write_video(tmp_path / "a.mp4", frames, (64, 48), fps=10)
    video = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    assert video.get(cv2.CAP_PROP_FPS) == pytest.approx(10)
    for expected in frames:
        good, found = video.read()
        assert good
        assert abs(float(found.mean()) - float(expected.mean())) < 6
    assert not video.read()[0]


@pytest.mark.parametrize(
    ("size", "shapes", "message"),
    [
        pytest.param((64, 48), [], "no frames", id="nothing"),
        pytest.param((64, 47), [(47, 64, 3)], "both have to be even", id="odd height"),
        pytest.param((0, 48), [], "both have to be even", id="no width"),
        pytest.param((64, 48), [(48, 64, 3), (48, 62, 3)], "in a video of 64 × 48", id="two sizes"),
    ],
)
def test_what_is_no_video_leaves_no_file(
    tmp_path: Path, size: tuple[int, int], shapes: list[tuple[int, ...]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        write_video(tmp_path / "a.mp4", [np.zeros(shape, np.uint8) for shape in shapes], size)
    assert list(tmp_path.iterdir()) == []


def test_the_same_frames_give_the_same_bytes(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    frames = [random.integers(0, 256, (48, 64, 3), dtype=np.uint8) for _ in range(5)]
    for name in ("a.mp4", "b.mp4"):
        write_video(tmp_path / name, frames, (64, 48))
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_the_file_says_how_its_colours_are_stored(tmp_path: Path) -> None:
    """Players guess otherwise, by the size of the picture, and show other colours."""
    write_video(tmp_path / "a.mp4", [np.full((48, 64, 3), (200, 30, 60), np.uint8)] * 3, (64, 48))
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    told = subprocess.run([ffmpeg, "-i", tmp_path / "a.mp4"], capture_output=True, text=True, check=False).stderr
    assert re.search(r"h264 .*yuv420p\(tv, bt709/bt709/iec61966-2-1", told), told
    words = ["-v", "error", "-i", str(tmp_path / "a.mp4"), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    pixels = subprocess.run([ffmpeg, *words], capture_output=True, check=True).stdout
    np.testing.assert_allclose(np.frombuffer(pixels, np.uint8).reshape(-1, 3).mean(axis=0), [200, 30, 60], atol=2)
