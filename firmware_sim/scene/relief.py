"""A worn bronze coin under the light arm's lamp or those of a dome, seen from above by an orthographic camera.

Light is Lambert and a modest GGX gloss; shadows are exact for distant light. To find them, the heights are turned so
that the light comes along the rows: a place lies in shadow if, towards the light, h − x·tan(elevation) is anywhere
greater than at the place itself, which one running maximum finds.
"""

import math
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from firmware_sim.config import ReliefScene
from firmware_sim.scene.pose import F32, LitLamp, Pose, Size

U8 = NDArray[np.uint8]
REFERENCE_HEIGHT = 480
PENUMBRA_PX = 0.6
"""Height over which a shadow's edge fades: the lamp is small, not a point."""
AMBIENT = 0.0006
GLOSS_ROUGHNESS = 0.30
GLOSS = 0.45
"""Weight of the gloss, which has the metal's own colour, beside the Lambert part."""
SEED = 11


class Relief:
    """The scene; the coin is struck once for each picture size."""

    def __init__(self, config: ReliefScene) -> None:
        self._config = config
        self._size: Size = (0, 0)
        self._coin: F32 = np.zeros((0, 0, 4), np.float32)

    def is_ready(self, pose: Pose, size: Size) -> bool:
        return True

    def light(self, poses: Sequence[Pose], size: Size) -> F32:
        if size != self._size:
            self._coin, self._size = strike(self._config, size), size
        views = [self._view(pose) for pose in poses]
        return views[0] if len(views) == 1 else np.mean(views, axis=0, dtype=np.float32)

    def _view(self, pose: Pose) -> F32:
        coin = _turn(self._coin, pose.turntable_deg if self._config.turns else 0.0, self._size)
        heights, albedo = np.ascontiguousarray(coin[..., 3]), coin[..., :3]
        light = albedo * np.float32(AMBIENT)
        for azimuth_deg, elevation_deg, power in (LitLamp(*pose[1:4]), *pose.dome):
            if power:
                light = light + np.float32(power) * shade(heights, albedo, azimuth_deg, elevation_deg)
        return light


def light_direction(azimuth_deg: float, elevation_deg: float) -> F32:
    """Return the unit vector to the lamp in the view frame: azimuth from x to y, elevation from there to z."""
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)], np.float32)


def shade(heights: F32, albedo: F32, azimuth_deg: float, elevation_deg: float) -> F32:
    """Light a height field, heights in pixels, with the full lamp: (H, W, 3)."""
    direction = light_direction(azimuth_deg, elevation_deg)
    normals = _normals(heights)
    incidence = np.maximum(normals @ direction, 0) * lit(heights, azimuth_deg, elevation_deg)
    half = direction + np.array([0, 0, 1], np.float32)
    half /= np.linalg.norm(half)
    facing2 = (normals @ half) ** 2
    a2 = np.float32(GLOSS_ROUGHNESS**2)
    lobe = a2 / (math.pi * (facing2 * (a2 - 1) + 1) ** 2) / (4 * float(half @ direction) ** 2)
    result: F32 = (incidence * (1 + np.float32(GLOSS) * lobe))[..., None] * albedo
    return result


def lit(heights: F32, azimuth_deg: float, elevation_deg: float) -> F32:
    """Return how much of the lamp each place of a height field sees, 0..1: (H, W)."""
    height, width = heights.shape
    side = math.ceil(math.hypot(height, width)) + 2
    # In a picture, whose rows run down, turning clockwise by the azimuth brings the light onto the x axis.
    forward = cv2.getRotationMatrix2D(((width - 1) / 2, (height - 1) / 2), -azimuth_deg, 1.0)
    forward[:, 2] += (side - width) // 2, (side - height) // 2  # whole pixels, so that no turn means no blur
    turned = cv2.warpAffine(heights, forward, (side, side), borderMode=cv2.BORDER_REPLICATE)
    # Beyond the picture nothing stands in the light, whatever the border was filled with.
    within = cv2.warpAffine(np.ones_like(heights), forward, (side, side), flags=cv2.INTER_NEAREST)
    slope = math.tan(math.radians(min(elevation_deg, 89.9)))
    lowered = np.where(within > 0, turned, np.float32(-1e6)) - np.arange(side, dtype=np.float32) * np.float32(slope)
    horizon = np.maximum.accumulate(lowered[:, ::-1], axis=1)[:, ::-1]
    # Places beyond the edge count as lit, since the edge's own pixels take their share of them on the way back.
    seen = np.where(within > 0, np.clip(1 - (horizon - lowered) / PENUMBRA_PX, 0, 1), 1).astype(np.float32)
    back = cv2.WARP_INVERSE_MAP | cv2.INTER_LINEAR
    return np.asarray(cv2.warpAffine(seen, forward, (width, height), flags=back), np.float32)


def strike(config: ReliefScene, size: Size) -> F32:
    """Make the coin on a square that is larger than the picture, so that it can turn.

    Returns
    -------
    coin : (S, S, 4) float32, albedo R, G, B and height in pixels; S exceeds the picture's diagonal
    """
    scale = size[0] / REFERENCE_HEIGHT
    side = math.ceil(math.hypot(*size)) + 2
    square = (side, side)
    across = (np.arange(side, dtype=np.float32) + 0.5 - side / 2) / scale
    radius = np.hypot(across[None, :], across[:, None])
    stamp = _stamp(config.text, side, scale)
    metal = np.clip((222 - radius) / 4, 0, 1)
    rim = np.clip(1 - np.abs(radius - 208) / 10, 0, 1) ** 0.5
    wear = 0.5 * _smooth_noise(square, 9 * scale) + 0.07 * _smooth_noise(square, 1.6 * scale)
    face = 5 + 4 * rim + 4.5 * stamp + wear - 0.7 * _scratches(side, scale)
    heights = (metal * face + 0.12 * _smooth_noise(square, 1.2)) * config.height * scale
    spots = 0.6 * _smooth_noise(square, 22 * scale) + 0.4 * _smooth_noise(square, 5 * scale)
    patina = np.clip(0.38 + 0.42 * spots - 0.45 * stamp - 0.35 * rim, 0, 1)[..., None]
    bronze = np.array([0.60, 0.38, 0.18]) * (1 - patina) + np.array([0.24, 0.30, 0.22]) * patina
    felt = np.array([0.055, 0.05, 0.075]) * (1 + 0.15 * _smooth_noise(square, 0.8)[..., None])
    albedo = np.clip(bronze * metal[..., None] + felt * (1 - metal[..., None]), 0.01, 1)
    return np.dstack([albedo, heights]).astype(np.float32)


def _stamp(text: str, side: int, scale: float) -> F32:
    """Draw what stands out of the coin, 0..1: the text, a leaf above it, a wreath of bumps, a ring: (S, S)."""

    def at(x: float, y: float) -> tuple[int, int]:
        return round(side / 2 + x * scale), round(side / 2 - y * scale)

    canvas = np.zeros((side, side), np.uint8)
    font, thick = cv2.FONT_HERSHEY_DUPLEX, max(1, round(8 * scale))
    (wide, tall), _ = cv2.getTextSize(text, font, 1.0, thick)
    font_scale = min(300 * scale / wide, 75 * scale / tall)
    (wide, tall), _ = cv2.getTextSize(text, font, font_scale, thick)
    x, y = at(0, -58)
    cv2.putText(canvas, text, (x - wide // 2, y + tall // 2), font, font_scale, 255, thick, cv2.LINE_AA)
    cv2.circle(canvas, at(0, 0), round(178 * scale), 255, max(1, round(3 * scale)), cv2.LINE_AA)
    for angle_rad in np.arange(30) * math.tau / 30:
        bump = at(193 * math.cos(angle_rad), 193 * math.sin(angle_rad))
        cv2.circle(canvas, bump, round(5 * scale), 255, -1, cv2.LINE_AA)
    soft = cv2.GaussianBlur(canvas, (0, 0), 1.8 * scale).astype(np.float32) / 255
    return np.asarray(np.maximum(soft, _leaf(side, at, scale)), np.float32)


def _leaf(side: int, at: Callable[[float, float], tuple[int, int]], scale: float) -> F32:
    """Draw a leaf that swells towards its middle, cut by veins: 0..1, (S, S)."""
    along = np.linspace(0, 1, 40)
    half_width = 42 * np.sin(np.pi * along**0.8)
    spine = 12 + 138 * along
    left, right = np.stack([-half_width, spine], 1), np.stack([half_width, spine], 1)[::-1]
    outline = np.array([at(float(x), float(y)) for x, y in np.concatenate([left, right])], np.int32)
    mask = np.zeros((side, side), np.uint8)
    cv2.fillPoly(mask, [outline], 255)
    swell = np.sqrt(cv2.distanceTransform(mask, cv2.DIST_L2, 5) / (42 * scale))
    veins = np.zeros((side, side), np.uint8)
    width = max(1, round(2.5 * scale))
    cv2.line(veins, at(0, -6), at(0, 150), 255, width, cv2.LINE_AA)
    for start in range(26, 122, 16):
        reach = 34 * math.sin(math.pi * ((start - 12) / 138) ** 0.8)
        for hand in (-1, 1):
            cv2.line(veins, at(0, start), at(hand * reach, start + 18), 200, max(1, width // 2), cv2.LINE_AA)
    cut = cv2.GaussianBlur(veins, (0, 0), 1.0 * scale).astype(np.float32) / 255
    return np.asarray(np.clip(cv2.GaussianBlur(swell, (0, 0), 1.5 * scale) - 0.5 * cut, 0, 1), np.float32)


def _scratches(side: int, scale: float) -> F32:
    """Draw fine lines that age has cut: their depth, 0..1, (S, S)."""
    random = np.random.default_rng(SEED)
    canvas = np.zeros((side, side), np.uint8)
    for x, y, angle_rad, length in random.uniform((0, 0, 0, 15), (1, 1, math.pi, 130), (60, 4)):
        start = (round(x * side), round(y * side))
        reach = (length * scale * math.cos(angle_rad), length * scale * math.sin(angle_rad))
        end = (round(start[0] + reach[0]), round(start[1] + reach[1]))
        cv2.line(canvas, start, end, int(random.integers(60, 255)), 1, cv2.LINE_AA)
    return np.asarray(cv2.GaussianBlur(canvas, (0, 0), 0.6 * scale).astype(np.float32) / 255, np.float32)


def _smooth_noise(size: Size, sigma_px: float) -> F32:
    """Return blurred noise with a standard deviation of 1: (H, W)."""
    noise = np.random.default_rng(SEED + round(10 * sigma_px)).standard_normal(size).astype(np.float32)
    blurred = cv2.GaussianBlur(noise, (0, 0), sigma_px)
    return np.asarray(blurred / blurred.std(), np.float32)


def _normals(heights: F32) -> F32:
    """Return unit normals of a height field in the view frame: (H, W, 3). Rows run down, y runs up."""
    along_rows, along_columns = np.gradient(heights)
    normals = np.stack([-along_columns, along_rows, np.ones_like(heights)], axis=-1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True), np.float32)


def _turn(coin: F32, angle_deg: float, size: Size) -> F32:
    """Turn the square counter-clockwise about its middle and cut the picture out of it."""
    height, width = size
    side = coin.shape[0]
    if not angle_deg % 360:
        top, left = (side - height) // 2, (side - width) // 2
        return coin[top : top + height, left : left + width]
    matrix = cv2.getRotationMatrix2D(((side - 1) / 2, (side - 1) / 2), angle_deg, 1.0)
    matrix[:, 2] -= (side - width) // 2, (side - height) // 2
    return np.asarray(cv2.warpAffine(coin, matrix, (width, height)), np.float32)
