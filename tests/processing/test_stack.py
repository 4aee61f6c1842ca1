from pathlib import Path

import cv2
import numpy as np
import pytest

from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.errors import FormatError, InputError
from processing.stack import Stack


def write_grey(path: Path, code: int, shape: tuple[int, int] = (6, 9)) -> Path:
    cv2.imwrite(str(path), np.full((*shape, 3), code, np.uint8))
    return path


def test_frames_come_in_the_order_of_their_names(tmp_path: Path) -> None:
    stack = Stack([write_grey(tmp_path / f"{code}.png", code) for code in (0, 51, 255)])
    assert len(stack) == 3
    assert stack.shape == (6, 9)
    assert [float(stack.encoded(index)[0, 0, 0]) for index in range(3)] == pytest.approx([0, 0.2, 1])


def test_linear_light_is_the_decoded_display_value(tmp_path: Path) -> None:
    stack = Stack([write_grey(tmp_path / "a.png", 128)])
    assert stack.linear(0)[2, 3, 1] == pytest.approx(((128 / 255 + 0.055) / 1.055) ** 2.4, rel=1e-5)
    assert stack.frame(0, "linear") == pytest.approx(stack.linear(0))
    assert stack.frame(0, "srgb") == pytest.approx(stack.encoded(0))


def test_a_correction_is_made_on_light(tmp_path: Path) -> None:
    path = write_grey(tmp_path / "a.png", 128)
    halved = Stack([path], lambda linear: linear * np.float32(0.5))
    assert halved.linear(0) == pytest.approx(Stack([path]).linear(0) / 2)
    assert halved.encoded(0)[0, 0, 0] == pytest.approx(1.055 * float(halved.linear(0)[0, 0, 0]) ** (1 / 2.4) - 0.055)


def test_frames_are_read_when_asked_for_and_not_before(tmp_path: Path) -> None:
    stack = Stack([write_grey(tmp_path / "a.png", 9), tmp_path / "not there.png"])
    assert stack.linear(0).shape == (6, 9, 3)
    with pytest.raises(InputError, match=r"not there\.png"):
        stack.linear(1)


def test_a_picture_of_another_size_is_named(tmp_path: Path) -> None:
    stack = Stack([write_grey(tmp_path / "a.png", 9), write_grey(tmp_path / "odd.png", 9, (6, 8))])
    assert stack.shape == (6, 9)
    with pytest.raises(FormatError, match=r"odd\.png: is 8 × 6 pixels.* 9 × 6"):
        stack.encoded(1)


def test_a_truncated_jpeg_is_named(tmp_path: Path) -> None:
    whole = write_grey(tmp_path / "whole.jpg", 90, (64, 64))
    cut = tmp_path / "cut.jpg"
    cut.write_bytes(whole.read_bytes()[:-40])
    with pytest.raises(FormatError, match=r"cut\.jpg"):
        Stack([whole, cut]).linear(1)


def test_a_stack_takes_one_role_of_a_capture(tmp_path: Path) -> None:
    frames = (CapturedFrame(tmp_path / "a.png"), CapturedFrame(tmp_path / "w.png", Role.WHITE))
    capture = Capture(tmp_path, "thing", frames)
    assert Stack.of(capture).paths == (tmp_path / "a.png",)
    assert Stack.of(capture, Role.WHITE).paths == (tmp_path / "w.png",)
    with pytest.raises(InputError, match="no pictures of role dark"):
        Stack.of(capture, Role.DARK)


def test_a_stack_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="no pictures"):
        Stack([])


def test_parts_of_all_pictures_are_worked_on_in_their_order(tmp_path: Path) -> None:
    stack = Stack([write_grey(tmp_path / f"{grey}.png", grey) for grey in (10, 200, 90, 30, 250, 7)])
    window = (slice(1, 4), slice(2, 9))
    found = list(stack.each(window, lambda index, part: (index, part.shape, float(part.mean()))))
    assert [(index, shape) for index, shape, _ in found] == [(index, (3, 7, 3)) for index in range(6)]
    assert [mean for _, _, mean in found] == pytest.approx([stack.linear(i).mean() for i in range(6)], rel=1e-5)


def test_the_culprit_is_named_among_pictures_worked_on_together(tmp_path: Path) -> None:
    paths = [write_grey(tmp_path / f"{grey}.png", grey) for grey in (10, 200, 90)]
    stack = Stack([*paths, write_grey(tmp_path / "odd.png", 9, (6, 8))])
    with pytest.raises(FormatError, match=r"odd\.png: is 8 × 6"):
        list(stack.each((slice(0, 3), slice(0, 3)), lambda _, part: part))
