"""From code values to light and back, and how good an exposure is."""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Codes = NDArray[np.uint8] | NDArray[np.uint16]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""What red, green and blue of linear sRGB count for in luminance (Rec. 709)."""


def decode_srgb(encoded: NDArray[np.floating]) -> F32:
    """Turn sRGB display values 0..1 into linear light 0..1 (IEC 61966-2-1)."""
    values = np.asarray(encoded, np.float32)
    return np.where(values <= 0.04045, values / 12.92, ((np.maximum(values, 0) + 0.055) / 1.055) ** 2.4).astype(
        np.float32
    )


def decode_srgb_codes(codes: Codes) -> F32:
    """Turn stored sRGB codes of 8 or 16 bits into linear light 0..1."""
    light = _light_of_codes(int(np.iinfo(codes.dtype).max))
    if codes.dtype == np.uint8:
        return np.asarray(cv2.LUT(np.ascontiguousarray(codes), light), np.float32)
    return light.take(codes)


@cache
def _light_of_codes(largest: int) -> F32:
    return decode_srgb(np.arange(largest + 1, dtype=np.float32) / np.float32(largest))


def encode_srgb(linear: NDArray[np.floating]) -> F32:
    """Turn linear light 0..1 into sRGB display values 0..1; what lies outside is cut off, as a display does."""
    values = np.clip(np.asarray(linear, np.float32), 0, 1)
    return np.where(values <= 0.0031308, values * 12.92, 1.055 * values ** (1 / 2.4) - 0.055).astype(np.float32)


def to_u8(values: NDArray[np.floating]) -> U8:
    """Round 0..1 to 0..255; what lies outside is cut off."""
    codes: U8 = np.rint(np.clip(values, 0, 1) * 255).astype(np.uint8)
    return codes


def clipped_share(codes: U8) -> float:
    """Share of pixels with a channel at its upper end, 0..1."""
    picture = codes if codes.ndim == 3 else codes[..., None]
    return float(np.mean(np.any(picture == 255, axis=-1)))


def sharpness(grey: NDArray[np.floating]) -> float:
    """Mean squared second difference of a picture (H, W), relative to its mean squared value; larger is sharper."""
    values = np.asarray(grey, np.float32)
    second = 4 * values[1:-1, 1:-1] - values[:-2, 1:-1] - values[2:, 1:-1] - values[1:-1, :-2] - values[1:-1, 2:]
    return float(np.mean(second**2) / max(float(np.mean(values**2)), 1e-12))
