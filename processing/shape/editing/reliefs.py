"""Heights and their gradients: pictures, noise and ripples."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from processing.shape.editing.perlin import layered_noise
from processing.shape.editing.places import Ground

F32 = NDArray[np.float32]
_SMALLEST_BLUR_PX = 0.7


@dataclass(frozen=True)
class Heights:
    """A relief over the pixels of a picture.

    Attributes
    ----------
    height : (H, W) float32
    gradient : (H, W, 3) float32, height by length
    """

    height: F32
    gradient: F32


def picture_heights(ground: Ground, heights: F32, height: float, size: float, turn_deg: float, repeat: bool) -> Heights:
    """Lay a height map (h, w) around the middle of the ground.

    What is smaller than a pixel of the picture is smoothed away first, and steps of 8 bits with it.

    Parameters
    ----------
    heights : 0 to 1
    height : of 1
    size : width of the map
    """
    rows, columns = heights.shape
    texel = size / columns
    border = cv2.BORDER_WRAP if repeat else cv2.BORDER_REPLICATE
    sigma = max(_SMALLEST_BLUR_PX, 0.5 * ground.step / texel)
    margin = int(np.ceil(4 * sigma)) + 1
    padded = cv2.copyMakeBorder(np.ascontiguousarray(heights, np.float32), margin, margin, margin, margin, border)
    smooth = cv2.GaussianBlur(padded, (0, 0), sigma)
    slope_x = cv2.Sobel(smooth, cv2.CV_32F, 1, 0, ksize=1, scale=0.5 / texel)
    slope_y = -cv2.Sobel(smooth, cv2.CV_32F, 0, 1, ksize=1, scale=0.5 / texel)
    right, top = ground.turned(turn_deg)
    apart = ground.points - ground.middle
    u = (apart @ right) / size + 0.5
    v = 0.5 - (apart @ top) / (texel * rows)
    inside = ground.faces if repeat else ground.faces & (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
    x, y = ((np.mod(u, 1) if repeat else u) * columns, (np.mod(v, 1) if repeat else v) * rows)
    places = ((x - 0.5 + margin).astype(np.float32), (y - 0.5 + margin).astype(np.float32))
    h, along, up = (
        np.where(inside, cv2.remap(plane, *places, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), 0) * height
        for plane in (smooth, slope_x, slope_y)
    )
    gradient = along[..., None] * right + up[..., None] * top
    return Heights(h.astype(np.float32), gradient.astype(np.float32))


def noise_heights(ground: Ground, height: float, scale: float, octaves: int, seed: int) -> Heights:
    """Make gradient noise over the ground's points; `height` is its amplitude, `scale` the length of its features."""
    values = layered_noise(np.ascontiguousarray(ground.points.reshape(-1, 3) / np.float32(scale)), octaves, seed)
    shape = ground.points.shape[:2]
    gradient = values[:, 1:].reshape(*shape, 3) * np.float32(height / scale)
    return Heights(values[:, 0].reshape(shape) * np.float32(height), gradient)


def ripple_heights(ground: Ground, height: float, wavelength: float, fade: float, phase_deg: float) -> Heights:
    """Make a wave around the ground's middle: h·sin(2π·r/λ + φ)·exp(−r/fade)."""
    apart = (ground.points - ground.middle).astype(np.float64)
    r = np.linalg.norm(apart, axis=-1)
    wave = 2 * np.pi * r / wavelength + np.radians(phase_deg)
    faded = np.where(ground.faces, height * np.exp(-r / fade), 0)
    slope = faded * (2 * np.pi / wavelength * np.cos(wave) - np.sin(wave) / fade)
    outwards = apart / np.maximum(r, 1e-9)[..., None]
    return Heights((faded * np.sin(wave)).astype(np.float32), (slope[..., None] * outwards).astype(np.float32))
