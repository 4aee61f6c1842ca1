"""A brushed sphere rendered by a few lines of its own: true rays, anisotropic lobes, four distant lights.

Nothing here is shared with what is tested. The brushing runs along parallels, so that the tangent at a point with
normal n is q × n with q in the picture's plane; its direction seen along z is the same everywhere.
"""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

LIGHTS = np.array([[0.5, 0.6, 0.62], [-0.7, 0.25, 0.67], [0.1, -0.75, 0.65], [-0.1, 0.1, 1.0]])
LIGHTS /= np.linalg.norm(LIGHTS, axis=1, keepdims=True)
LIGHT_COLOURS = np.array([[0.9, 0.8, 0.7], [0.3, 0.5, 0.8], [0.5, 0.3, 0.3], [0.35, 0.35, 0.35]])


def _dot(a: F64, b: F64) -> F64:
    return np.asarray(np.sum(a * b, axis=-1, keepdims=True))


def _unit(a: F64) -> F64:
    return np.asarray(a / np.maximum(np.linalg.norm(a, axis=-1, keepdims=True), 1e-12))


def _lobe(half: F64, normal: F64, tangent: F64, rough_t: float, rough_b: float) -> F64:
    """Ward's anisotropic exponential."""
    along, across = _dot(half, tangent), _dot(half, np.cross(normal, tangent))
    upright = np.maximum(_dot(half, normal), 1e-3)
    return np.asarray(np.exp(-((along / rough_t) ** 2 + (across / rough_b) ** 2) / upright**2))


def _turned(tangent: F64, normal: F64, angle_deg: float) -> F64:
    angle = np.radians(angle_deg)
    return np.asarray(np.cos(angle) * tangent + np.sin(angle) * np.cross(normal, tangent))


def _material(kind: str, half: F64, normal: F64, tangent: F64) -> F64:
    if kind == "isotropic":
        return _lobe(half, normal, tangent, 0.3, 0.3)
    if kind == "2":
        return _lobe(half, normal, tangent, 0.18, 0.5)
    if kind == "4":
        crossed = [_lobe(half, normal, _turned(tangent, normal, angle_deg), 0.15, 0.6) for angle_deg in (0, 90)]
        return (crossed[0] + crossed[1]) / 2
    total = np.zeros_like(half[..., :1])
    spokes = {"1": (0.0,), "3": (0.0, 120.0, 240.0)}[kind]
    for angle_deg in spokes:
        direction = _turned(tangent, normal, angle_deg)
        tilted = _unit(normal + 0.3 * direction)
        total += _lobe(half, tilted, _unit(direction - _dot(direction, tilted) * tilted), 0.3, 0.3) / len(spokes)
    return total


def shade(kind: str, normal: F64, tangent: F64, to_eye: F64, lights: int = 4, ambient: float = 0.02) -> F64:
    """Linear light (..., 3) of points with these unit vectors (..., 3)."""
    light = np.full(normal.shape, ambient)
    for direction, colour in zip(LIGHTS[:lights], LIGHT_COLOURS[:lights], strict=True):
        half = _unit(direction + to_eye)
        facing = np.maximum(_dot(normal, direction), 0)
        light = light + facing * (0.15 + 0.8 * _material(kind, half, normal, tangent)) * colour
    return light


def tangent_at(normal: F64, tau_deg: float | F64) -> F64:
    tau = np.radians(tau_deg)
    axis = np.stack(np.broadcast_arrays(-np.sin(tau), np.cos(tau), 0.0), axis=-1)
    return _unit(np.cross(np.broadcast_to(axis, normal.shape), normal))


def true_table(kind: str, size: int, taus_deg: F64) -> tuple[F64, F64]:
    """Orthographic truth: slices (D, S, S, 3) with row 0 at n_y = +1, and the radius (S, S) of each texel's normal."""
    line = (2 * np.arange(size) + 1) / size - 1
    n_x, n_y = np.meshgrid(line, -line)
    radius = np.hypot(n_x, n_y)
    normal = np.stack([n_x, n_y, np.sqrt(np.maximum(1 - radius**2, 0))], axis=-1)
    eye = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
    return np.stack([shade(kind, normal, tangent_at(normal, tau), eye) for tau in taus_deg]), radius


def encode(linear: F64) -> F64:
    values = np.clip(linear, 0, 1)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1 / 2.4) - 0.055)


@dataclass
class Scene:
    kind: str = "2"
    circle: tuple[float, float, float] = (83.3, 77.8, 60.4)
    shape: tuple[int, int] = (156, 168)
    distance_radii: float | None = None
    background: str = "grey"
    tangent_zero_deg: float = 0.0
    samples: int = 3
    noise: float = 0.0
    lights: int = 4
    ambient: float = 0.02
    _seed: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))

    def picture(self, angle_deg: float) -> F64:
        """Linear light (H, W, 3) with the sphere turned by this angle, antialiased by a box."""
        height, width = self.shape
        fine_y, fine_x = ((np.arange(n * self.samples) + 0.5) / self.samples for n in (height, width))
        x = (fine_x[None, :] - self.circle[0]) / self.circle[2] + 0 * fine_y[:, None]
        y = -(fine_y[:, None] - self.circle[1]) / self.circle[2] + 0 * fine_x[None, :]
        light = self._behind(fine_x[None, :] + 0 * y, fine_y[:, None] + 0 * x)
        hit, normal, to_eye = self._hits(x, y)
        tangent = tangent_at(normal, angle_deg + self.tangent_zero_deg)
        light[hit] = shade(self.kind, normal, tangent, to_eye, self.lights, self.ambient)
        light = light.reshape(height, self.samples, width, self.samples, 3).mean(axis=(1, 3))
        return np.asarray(light + self.noise * self._seed.standard_normal(light.shape))

    def _hits(self, x: F64, y: F64) -> tuple[NDArray[np.bool_], F64, F64]:
        inside = x**2 + y**2 < 1
        if self.distance_radii is None:
            normal = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)[inside]
            return inside, normal, np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
        eye = np.array([0.0, 0.0, self.distance_radii])
        focal = np.sqrt(self.distance_radii**2 - 1)
        ray = _unit(np.stack([x / focal, y / focal, -np.ones_like(x)], axis=-1))[inside]
        middle = -_dot(ray, np.broadcast_to(eye, ray.shape))
        reach = middle - np.sqrt(np.maximum(middle**2 - (self.distance_radii**2 - 1), 0))
        return inside, _unit(eye + reach * ray), -ray

    def _behind(self, x: F64, y: F64) -> F64:
        grey = {
            "grey": 0.2 + 0 * x,
            "black": 0.0 * x,
            "white": 0.8 + 0 * x,
            "clutter": 0.3 + 0.2 * np.sign(np.sin(x / 9) * np.sin(y / 7 + x / 40)) + 0.1 * np.sin(x * y / 500),
        }[self.background]
        return np.asarray(np.repeat(grey[..., None], 3, axis=-1) * np.array([1.0, 0.9, 0.8]))

    def shoot(self, folder: Path, angles_deg: F64, ending: str = ".png", gain: float = 1.0) -> Path:
        """Write a plain folder: one picture an angle, and angles.csv."""
        folder.mkdir(parents=True, exist_ok=True)
        lines = ["name,deg"]
        for index, angle in enumerate(angles_deg):
            name = f"frame_{index:04d}{ending}"
            codes = np.rint(encode(gain * self.picture(float(angle))) * 255).astype(np.uint8)
            quality = [cv2.IMWRITE_JPEG_QUALITY, 95] if ending == ".jpg" else []
            cv2.imwrite(str(folder / name), codes[..., ::-1], quality)
            lines.append(f"{name},{float(angle):.6f}")
        (folder / "angles.csv").write_text("\n".join(lines) + "\n")
        return folder
