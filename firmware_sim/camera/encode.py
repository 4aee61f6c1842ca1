"""Pictures as the camera sends them: Motion JPEG or YUYV."""

from typing import Literal

import cv2
import numpy as np
import simplejpeg
from numpy.typing import NDArray

from firmware_sim.camera.shared_frame import MJPG

U8 = NDArray[np.uint8]
Subsampling = Literal["444", "422"]


def encode(picture_srgb: U8, pixel_format: int, quality: int, subsampling: Subsampling) -> bytes:
    """Encode a picture in the format that the client asked for.

    Parameters
    ----------
    picture_srgb : (H, W, 3) uint8, RGB, row 0 on top, W even
    pixel_format : V4L2 code of Motion JPEG; anything else becomes YUYV
    quality, subsampling : of the JPEG
    """
    if pixel_format == MJPG:
        return bytes(simplejpeg.encode_jpeg(picture_srgb, quality, colorspace="RGB", colorsubsampling=subsampling))
    return yuyv(picture_srgb).tobytes()


def yuyv(picture_srgb: U8) -> U8:
    """Pack a picture as Y U Y V, limited range (BT.601), each pair of pixels sharing its chroma: (H, W, 2) uint8."""
    rgb = picture_srgb.astype(np.float32)
    luma = 16 + rgb @ np.array([65.481, 128.553, 24.966], np.float32) / 255
    pairs = (rgb[:, 0::2] + rgb[:, 1::2]) / 2
    packed = np.zeros((*picture_srgb.shape[:2], 2), np.float32)
    packed[..., 0] = luma
    packed[:, 0::2, 1] = 128 + pairs @ np.array([-37.797, -74.203, 112.0], np.float32) / 255
    packed[:, 1::2, 1] = 128 + pairs @ np.array([112.0, -93.786, -18.214], np.float32) / 255
    return np.asarray(cv2.convertScaleAbs(packed), np.uint8)
