"""A small demo, whole: what it promises is there, and nothing on its page points outside its folder."""

import json
from html.parser import HTMLParser
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.capture_folder.verify import verify_capture
from litrig.base.pictures import read_codes
from tests.system.browser import look_at, needs_browser
from tests.system.command import litrig


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("demo") / "out"
    result = litrig("demo", "--out", folder, "--small", "--scene", "analytic")
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip() == f"The demo is complete: open {folder / 'index.html'}"
    assert "100/100" in result.stderr
    return folder


def picture_of(path: Path) -> NDArray[np.integer]:
    """Read a picture, or a frame of a video."""
    if path.suffix != ".mp4":
        return read_codes(path)
    good, frame = cv2.VideoCapture(str(path)).read()
    assert good
    return np.asarray(frame, np.uint8)


class Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.links += [value for name, value in attrs if name in ("src", "href") and value]


def test_every_picture_of_the_page_is_a_file_beside_it(demo: Path) -> None:
    page = (demo / "index.html").read_text(encoding="utf-8")
    links = Links()
    links.feed(page)
    assert len(links.links) >= 15
    assert "//" not in page
    for link in links.links:
        assert picture_of(demo / link).std() > 3, f"{link} shows nothing"


def test_both_captures_are_valid_bags(demo: Path) -> None:
    for name, frames in (("brushed", 16), ("relief", 12)):
        result = verify_capture(demo / "captures" / name)
        assert (result.frames, result.closed, result.findings) == (frames, True, ())


def test_the_brushed_sphere_is_found_to_repeat_at_half_a_turn(demo: Path) -> None:
    result = litrig("amc", "info", demo / "brushed.amc.ktx2", "--json")
    assert json.loads(result.stdout)["invariance"] == 2, result.stdout


def test_the_four_lights_show_four_pictures(demo: Path) -> None:
    pictures = [read_codes(demo / f"pictures/ptm-{index}.png").astype(float) for index in range(4)]
    for first in range(4):
        for second in range(first):
            assert np.abs(pictures[first] - pictures[second]).mean() > 4


def test_a_second_demo_replaces_the_first_but_nothing_else(demo: Path, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    result = litrig("demo", "--out", tmp_path, "--small")
    assert result.returncode == 1
    assert "not an earlier demo" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


@needs_browser
def test_a_browser_shows_the_page(demo: Path, tmp_path: Path) -> None:
    assert look_at(demo / "index.html", tmp_path)[:2000].std() > 10
