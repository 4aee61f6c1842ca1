"""A relief with cast shadows under a dome of lights, rendered by a few lines of its own."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


def dome(count: int, lowest_deg: float = 20.0) -> F64:
    """Light directions (N, 3) on a spiral from the top down."""
    steps = (np.arange(count) + 0.5) / count
    elevation = np.arcsin(1 - steps * (1 - np.sin(np.radians(lowest_deg))))
    azimuth = np.arange(count) * np.pi * (3 - np.sqrt(5))
    flat = np.cos(elevation)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=1)


def heights(size: int) -> F64:
    y, x = np.mgrid[:size, :size] / size
    hills: F64 = 9 * np.exp(-40 * ((x - 0.35) ** 2 + (y - 0.4) ** 2)) + 2 * np.sin(14 * x) * np.cos(11 * y)
    hills[(np.hypot(x - 0.7, y - 0.7) < 0.12)] += 6
    return hills


def relief_pictures(light_dirs: F64, size: int = 48) -> F64:
    """Display values (N, S, S, 3), 0..1, of coloured Lambert and a little gloss, with shadows cast along each light."""
    height = heights(size)
    slope_y, slope_x = np.gradient(height)
    normal = np.stack([-slope_x, slope_y, np.ones_like(height)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    y, x = np.mgrid[:size, :size] / size
    albedo = np.stack([0.75 + 0 * x, 0.35 + 0.4 * x, 0.25 + 0.3 * y], axis=-1)
    albedo[: size // 8, : size // 8] = 0
    pictures = []
    for light in light_dirs:
        half = (light + np.array([0, 0, 1])) / np.linalg.norm(light + np.array([0, 0, 1]))
        gloss = 0.3 * np.maximum(normal @ half, 0) ** 30
        lit = np.maximum(normal @ light, 0) * ~_shadowed(height, light)
        linear = np.clip(albedo * lit[..., None] + (albedo > 0) * (gloss * (lit > 0))[..., None], 0, 1)
        pictures.append(np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055))
    return np.stack(pictures)


def _shadowed(height: F64, light: F64) -> NDArray[np.bool_]:
    rows, columns = np.indices(height.shape)
    dark = np.zeros(height.shape, bool)
    for step in range(1, 24):
        row = np.clip(np.rint(rows - step * light[1]).astype(int), 0, height.shape[0] - 1)
        column = np.clip(np.rint(columns + step * light[0]).astype(int), 0, height.shape[1] - 1)
        dark |= height[row, column] > height + step * light[2] + 0.3
    return dark


def write_relief(folder: Path, light_dirs: F64, size: int = 48) -> list[Path]:
    """Write a plain folder: 8-bit pictures and an .lp."""
    folder.mkdir(parents=True, exist_ok=True)
    lines, paths = [str(len(light_dirs))], []
    for index, picture in enumerate(relief_pictures(light_dirs, size)):
        paths.append(folder / f"light_{index:03d}.png")
        cv2.imwrite(str(paths[-1]), np.rint(picture[..., ::-1] * 255).astype(np.uint8))
        lines.append(f"{paths[-1].name} " + " ".join(f"{part:.9f}" for part in light_dirs[index]))
    (folder / "relief.lp").write_text("\n".join(lines) + "\n")
    return paths
