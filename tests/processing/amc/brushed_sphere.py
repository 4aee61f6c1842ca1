"""A brushed sphere rendered by a few lines of its own: true rays, anisotropic lobes, four distant lights.

Nothing here is shared with what is tested. The brushing runs along parallels, so that the tangent at a point with
normal n is q × n with q in the picture's plane; its direction seen along z is the same everywhere.
"""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
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
    offset_px: float = 0.0
    phase_deg: float = 0.0
    wobble_px: float = 0.0
    plate: str = "none"
    seams: int = 0
    dirt: float = 0.0
    blur_px: float = 0.0
    gain: float = 1.0
    _seed: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))

    def circle_at(self, angle_deg: float) -> tuple[float, float, float]:
        """The silhouette at a turntable angle: `circle`, carried round by a mounting off the axis and by play."""
        round_rad, play = np.radians(angle_deg + self.phase_deg), np.radians(angle_deg)
        x_px = self.offset_px * np.cos(round_rad) + self.wobble_px * np.sin(2 * play + 1)
        y_px = -self.offset_px * np.sin(round_rad) + self.wobble_px * np.sin(3 * play)
        return self.circle[0] + float(x_px), self.circle[1] + float(y_px), self.circle[2]

    def picture(self, angle_deg: float) -> F64:
        """Linear light (H, W, 3) with the sphere turned by this angle, antialiased by a box."""
        height, width = self.shape
        fine_y, fine_x = np.meshgrid(
            *((np.arange(n * self.samples) + 0.5) / self.samples for n in (height, width)), indexing="ij"
        )
        light = self._behind(fine_x, fine_y)
        self._lay_plate(light, fine_x, fine_y, angle_deg)
        centre_x, centre_y, radius = self.circle_at(angle_deg)
        hit, normal, to_eye = self._hits((fine_x - centre_x) / radius, (centre_y - fine_y) / radius)
        tangent = tangent_at(normal, angle_deg + self.tangent_zero_deg)
        light[hit] = shade(self.kind, normal, tangent, to_eye, self.lights, self.ambient)
        light[hit] *= self._albedo(normal, angle_deg)
        if self.blur_px:
            light = np.asarray(cv2.GaussianBlur(light, (0, 0), self.blur_px * self.samples), np.float64)
        light = self.gain * light.reshape(height, self.samples, width, self.samples, 3).mean(axis=(1, 3))
        return np.asarray(light + self.noise * self._seed.standard_normal(light.shape))

    def _albedo(self, normal: F64, angle_deg: float) -> F64:
        """Dirt and cuts of the cover, which turn with it; (N, 1)."""
        azimuth = np.arctan2(normal[:, 1], normal[:, 0]) - np.radians(angle_deg)
        flat = np.hypot(normal[:, 0], normal[:, 1])
        u, v = flat * np.cos(azimuth), flat * np.sin(azimuth)
        albedo = 1 + self.dirt * np.sin(11 * u + 3 * np.sin(7 * v)) * np.sin(13 * v + 2 * np.cos(5 * u))
        for seam in range(self.seams):
            away = np.angle(np.exp(1j * (azimuth - 0.4 - 2 * np.pi * seam / self.seams)))
            albedo[(np.abs(away) * flat < 0.04) & (flat > 0.4)] *= 0.15
        return np.asarray(albedo[:, None])

    def _lay_plate(self, light: F64, x: F64, y: F64, angle_deg: float) -> None:
        """A printed board under the sphere that turns with it."""
        if self.plate == "none":
            return
        turn = np.radians(angle_deg)
        right, up = (x - self.circle[0]) / self.circle[2], (self.circle[1] - y) / self.circle[2]
        u = right * np.cos(turn) + up * np.sin(turn)
        v = up * np.cos(turn) - right * np.sin(turn)
        print_ = 0.35 + 0.2 * np.sin(7 * u + 3 * np.sin(5 * v)) + 0.12 * np.sign(np.sin(9 * v + 1.3) * np.sin(8 * u))
        reach = {"all over": 0 * u, "round": np.hypot(u, v) / 1.4, "square": np.maximum(np.abs(u), np.abs(v)) / 1.25}
        laid = reach[self.plate] < 1
        light[laid] = (print_[..., None] * np.array([0.9, 1.0, 0.7]))[laid]

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
        if self.background == "limb":
            return self._like_limb(x, y)
        grey = {
            "grey": 0.2 + 0 * x,
            "black": 0.0 * x,
            "white": 0.8 + 0 * x,
            "gradient": 0.15 + 0.5 * x / self.shape[1] - 0.1 * y / self.shape[0],
            "clutter": 0.3 + 0.2 * np.sign(np.sin(x / 9) * np.sin(y / 7 + x / 40)) + 0.1 * np.sin(x * y / 500),
        }[self.background]
        return np.asarray(np.repeat(grey[..., None], 3, axis=-1) * np.array([1.0, 0.9, 0.8]))

    def _like_limb(self, x: F64, y: F64) -> F64:
        """As bright as the rim is at turntable zero, all around."""
        right, up = x - self.circle[0], self.circle[1] - y
        far = np.maximum(np.hypot(right, up), 1e-9)
        normal = _unit(np.stack([right / far, up / far, np.full_like(far, 0.02)], axis=-1))
        eye = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
        return shade(self.kind, normal, tangent_at(normal, self.tangent_zero_deg), eye, self.lights, self.ambient)

    def shoot(self, folder: Path, angles_deg: F64, ending: str = ".png", gain: float = 1.0) -> Path:
        """Write a plain folder: one picture an angle, and angles.csv."""
        folder.mkdir(parents=True, exist_ok=True)
        lines = ["name,deg"]
        for index, angle in enumerate(angles_deg):
            name = f"frame_{index:04d}{ending}"
            _write(folder / name, gain * self.picture(float(angle)))
            lines.append(f"{name},{float(angle):.6f}")
        (folder / "angles.csv").write_text("\n".join(lines) + "\n")
        return folder


def _write(path: Path, linear: F64) -> None:
    if path.suffix == ".exr":
        OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": linear.astype(np.float32)}).write(str(path))
        return
    codes = np.rint(encode(linear) * 255).astype(np.uint8)
    cv2.imwrite(str(path), codes[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 95] if path.suffix == ".jpg" else [])
