import cv2
import numpy as np
import pytest
import simplejpeg

from firmware_sim.camera.encode import Subsampling, encode, yuyv
from firmware_sim.camera.shared_frame import MJPG, YUYV


def picture() -> np.ndarray:
    rows, columns = np.mgrid[0:48, 0:64]
    return np.stack([4 * columns, 5 * rows, 255 - 2 * columns - rows], axis=-1).astype(np.uint8)


@pytest.mark.parametrize("subsampling", ["444", "422"])
def test_a_jpeg_decodes_to_the_picture(subsampling: Subsampling) -> None:
    content = encode(picture(), MJPG, 95, subsampling)
    assert simplejpeg.decode_jpeg_header(content) == (48, 64, "YCbCr", subsampling)
    decoded = simplejpeg.decode_jpeg(content).astype(int)
    assert np.abs(decoded - picture()).mean() < 2


def test_opencv_decodes_our_yuyv_to_the_picture() -> None:
    decoded = cv2.cvtColor(yuyv(picture()), cv2.COLOR_YUV2RGB_YUYV).astype(int)
    assert np.abs(decoded - picture())[2:-2, 2:-2].mean() < 2.5


@pytest.mark.parametrize(("level", "luma"), [(0, 16), (255, 235)])
def test_yuyv_has_limited_range(level: int, luma: int) -> None:
    packed = yuyv(np.full((2, 4, 3), level, np.uint8))
    assert (packed[..., 0] == luma).all()
    assert (packed[..., 1] == 128).all()


def test_a_raw_picture_has_two_bytes_a_pixel() -> None:
    assert len(encode(picture(), YUYV, 95, "422")) == 48 * 64 * 2
