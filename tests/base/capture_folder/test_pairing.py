import json
from pathlib import Path

import numpy as np
import pytest

from litrig.base.capture_folder.pairing import in_order
from litrig.base.capture_folder.reader import read_capture
from litrig.base.errors import InputError
from litrig.base.pictures import write_codes


def folder_of(tmp_path: Path, names: list[str], lp: str | bytes) -> Path:
    for name in names:
        write_codes(tmp_path / name, np.zeros((2, 2, 3), np.uint8))
    (tmp_path / "x.lp").write_bytes(lp if isinstance(lp, bytes) else lp.encode())
    return tmp_path


@pytest.mark.parametrize(
    ("pictures", "lp"),
    [
        pytest.param(["b.png", "a.png"], "b.png 0 0 1\na.png 1 0 0", id="as they are"),
        pytest.param(["b.png", "a.png"], "B.PNG 0 0 1\nA.png 1 0 0", id="capitals"),
        pytest.param(["b.jpg", "a.jpg"], "b.tif 0 0 1\nA.TIF 1 0 0", id="developed into another format"),
        pytest.param(["b.jpg", "a.jpg"], "raw\\b.dng 0 0 1\nraw\\a.dng 1 0 0", id="in another folder"),
        pytest.param(["한.png", "글.png"], "한.png 0 0 1\n글.png 1 0 0".encode("cp949"), id="another code page"),
    ],
)
def test_names_are_found_as_a_person_would(tmp_path: Path, pictures: list[str], lp: str | bytes) -> None:
    capture = read_capture(folder_of(tmp_path, pictures, lp))
    assert [frame.path.name for frame in capture.frames] == pictures
    assert np.array([frame.light for frame in capture.frames]) == pytest.approx(np.array([[0, 0, 1], [1, 0, 0]]))
    assert capture.remarks == ()


def test_the_exact_name_comes_first(tmp_path: Path) -> None:
    pictures = ["A.png", "a.png", "a.jpg"]
    capture = read_capture(folder_of(tmp_path, pictures, "a.png 0 0 1\nA.png 1 0 0\na.jpg 0 1 0"))
    assert [frame.path.name for frame in capture.frames] == ["a.png", "A.png", "a.jpg"]


@pytest.mark.parametrize(
    ("lp", "reason"),
    [
        pytest.param(
            "c.png 0 0 1\na.png 0 0 1", r"names c\.png, not found in .* holds a\.jpg, b\.png instead", id="gone"
        ),
        pytest.param("a.tif 0 0 1", r"a\.tif fits a\.jpg, a\.png; keep one", id="two fit"),
        pytest.param("b.tif 0 0 1\nb.png 0 0 1", r"b\.tif, b\.png both mean b\.png", id="named twice"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, lp: str, reason: str) -> None:
    with pytest.raises(InputError, match=rf"x\.lp: {reason}"):
        read_capture(folder_of(tmp_path, ["a.png", "a.jpg", "b.png"], lp))


def test_pictures_without_a_light_are_remarked_on(tmp_path: Path) -> None:
    capture = read_capture(folder_of(tmp_path, ["a.png", "mask.png"], "a.png 0 0 1"))
    assert len(capture.frames) == 1
    assert capture.remarks[0].endswith("x.lp: has no light for mask.png; left out")


def test_lights_without_names_are_paired_in_order_with_a_remark(tmp_path: Path) -> None:
    capture = read_capture(folder_of(tmp_path, ["p10.png", "p9.png"], "2\n0 0 1\n1 0 0\n"))
    assert [frame.path.name for frame in capture.frames] == ["p9.png", "p10.png"]
    assert np.array([frame.light for frame in capture.frames]) == pytest.approx(np.array([[0, 0, 1], [1, 0, 0]]))
    assert "names no pictures; paired in their order, p9.png first" in capture.remarks[0]


def test_more_lights_than_pictures_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"x\.lp: has 2 lights without names, and .* 1 pictures"):
        read_capture(folder_of(tmp_path, ["a.png"], "0 0 1\n1 0 0\n"))


def test_a_dome_beside_the_pictures_gives_their_positions_and_gains(tmp_path: Path) -> None:
    folder = folder_of(tmp_path, ["a.png"], b"")
    (folder / "x.lp").unlink()
    dome = {"lightConfiguration": "lights3d", "imageWidth": 50, "positions3d": [{"x": 0, "y": 30, "z": 40}]}
    (folder / "x.dome").write_text(json.dumps({**dome, "ledAdjust": [{"r": 1, "g": 2, "b": 3}]}))
    capture = read_capture(folder)
    assert capture.picture_width_mm == 50
    assert capture.frames[0].light == pytest.approx(np.array([0, 0.6, 0.8]))
    assert capture.frames[0].light_position_mm == pytest.approx(np.array([0, 30, 40]))
    assert capture.frames[0].light_gain == pytest.approx(np.array([1, 2, 3]))


def test_numbers_in_names_are_counted() -> None:
    assert in_order(["p10", "p9b", "p9", "q1", "p009"]) == ["p9", "p009", "p9b", "p10", "q1"]
