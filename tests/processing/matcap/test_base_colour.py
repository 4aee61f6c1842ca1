import numpy as np
import pytest

from processing.matcap.base_colour import white_patch

EVERYWHERE = np.ones((4, 4), np.bool_)


def test_the_base_colour_is_that_of_the_brightest_pixel() -> None:
    picture = np.full((4, 4, 3), 0.1, np.float32)
    picture[1, 2] = 0.8, 0.6, 0.2
    assert white_patch(picture, EVERYWHERE) == pytest.approx((0.8, 0.6, 0.2))


def test_brightest_means_luminance_not_any_channel() -> None:
    picture = np.zeros((4, 4, 3), np.float32)
    picture[0, 0] = 0.1, 0.1, 1.0
    picture[3, 3] = 0.3, 0.6, 0.1
    assert white_patch(picture, EVERYWHERE) == pytest.approx((0.3, 0.6, 0.1))


def test_pixels_as_bright_as_the_brightest_count_together() -> None:
    picture = np.zeros((4, 4, 3), np.float32)
    picture[0, 0] = 0.5, 0.5, 0.3
    picture[0, 1] = 0.4995, 0.4995, 0.31
    assert white_patch(picture, EVERYWHERE)[2] == pytest.approx(0.305)


def test_what_the_mask_leaves_out_does_not_count() -> None:
    picture = np.full((4, 4, 3), 0.25, np.float32)
    picture[0] = 1
    mask = EVERYWHERE.copy()
    mask[0] = False
    assert white_patch(picture, mask) == pytest.approx((0.25, 0.25, 0.25))


def test_a_dark_channel_can_still_be_divided_by() -> None:
    picture = np.zeros((4, 4, 3), np.float32)
    picture[1, 1] = 0.5, 1.0, 0.0
    picture[2, 2] = 0.0, 0.0, 0.5
    assert white_patch(picture, EVERYWHERE) == pytest.approx((0.5, 1.0, 1 / 256))


def test_black_is_taken_for_white() -> None:
    assert white_patch(np.zeros((4, 4, 3), np.float32), EVERYWHERE) == (1, 1, 1)
