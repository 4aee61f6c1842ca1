"""Mirror balls on a table under a lamp, ray by ray, in a few lines that know nothing of the product's geometry."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.pictures import write_codes, write_picture
from litrig.base.radiometry import encode_srgb, to_u8

F64 = NDArray[np.float64]
SHAPE = (120, 160)


def lamps(count: int, lowest_deg: float = 25.0) -> F64:
    """Light directions (N, 3) on a spiral from the top down."""
    height = np.linspace(np.sin(np.radians(80)), np.sin(np.radians(lowest_deg)), count)
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    flat = np.sqrt(1 - height**2)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)


@dataclass(frozen=True)
class Balls:
    """What stands before the camera.

    Attributes
    ----------
    balls : x, y and radius of each, in pixels; in perspective those of the sphere's centre and a point beside it
    distance_radii : of the camera to the plane of the centres, in radii of the first; None for orthographic
    background : "table" is grey, "cloth" dark, "black" velvet
    lamp_deg : angular radius of the lamp
    window : a light in the room that always shines, mirrored too
    """

    balls: tuple[tuple[float, float, float], ...] = ((70.3, 58.8, 41.6),)
    shape: tuple[int, int] = SHAPE
    distance_radii: float | None = None
    background: str = "table"
    lamp_deg: float = 4.0
    lamp: float = 30.0
    window: float = 0.25
    noise: float = 0.0
    samples: int = 3
    dark: tuple[int, ...] = ()
    second: dict[int, tuple[float, float, float]] = field(default_factory=dict)

    @property
    def focal_px(self) -> float:
        assert self.distance_radii is not None
        return self.balls[0][2] * self.distance_radii

    def outlines(self) -> list[tuple[float, float, float]]:
        """Centre and mean radius of each outline, from its own points."""
        if self.distance_radii is None:
            return list(self.balls)
        found = []
        for centre, radius in self._spheres():
            beta = np.arcsin(radius / np.linalg.norm(centre))
            axis = centre / np.linalg.norm(centre)
            side = np.cross(axis, [0.0, 1.0, 0.0])
            side /= np.linalg.norm(side)
            turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)[:, None]
            around = np.cos(turn) * side + np.sin(turn) * np.cross(axis, side)
            rays = np.cos(beta) * axis + np.sin(beta) * around
            x = self.shape[1] / 2 - self.focal_px * rays[:, 0] / rays[:, 2]
            y = self.shape[0] / 2 + self.focal_px * rays[:, 1] / rays[:, 2]
            middle = (x.max() + x.min()) / 2, (y.max() + y.min()) / 2
            found.append((*middle, float(np.hypot(x - middle[0], y - middle[1]).mean())))
        return found

    def picture(self, light: F64, index: int = 0) -> F64:
        """Linear light (H, W, 3) under a lamp far away in this direction."""
        height, width = self.shape
        fine = (np.arange(height * self.samples) + 0.5) / self.samples, (np.arange(width * self.samples) + 0.5)
        y, x = np.meshgrid(fine[0], fine[1] / self.samples, indexing="ij")
        origin, ray = self._rays(x, y)
        grey = {"black": 0.002, "table": 0.12, "cloth": 0.02}[self.background]
        strength = 0.0 if index in self.dark else 1.0
        light_seen = np.full(x.shape, grey * (0.15 + strength * max(light[2], 0)))
        for centre, radius in self._spheres():
            offset = origin - centre
            along = np.sum(offset * ray, axis=-1)
            below = along**2 - np.sum(offset**2, axis=-1) + radius**2
            hit = below > 0
            point = offset + (-along - np.sqrt(np.maximum(below, 0)))[..., None] * ray
            normal = point / radius
            mirrored = ray - 2 * np.sum(ray * normal, axis=-1, keepdims=True) * normal
            light_seen[hit] = 0.6 * self._room(mirrored[hit], light, index, strength, grey)
        fine_shape = (height, self.samples, width, self.samples)
        linear = light_seen.reshape(fine_shape).mean(axis=(1, 3))
        linear = linear + self.noise * np.random.default_rng(index).standard_normal(linear.shape)
        return np.repeat(np.maximum(linear, 0)[..., None], 3, axis=-1)

    def shoot(self, folder: Path, lights: F64, ending: str = ".png", stem: str = "light") -> Path:
        folder.mkdir(parents=True, exist_ok=True)
        for index, light in enumerate(lights):
            path = folder / f"{stem}_{index:02d}{ending}"
            linear = self.picture(light, index)
            if ending == ".exr":
                write_picture(path, linear)
            else:
                write_codes(path, to_u8(encode_srgb(linear)))
        return folder

    def _spheres(self) -> list[tuple[F64, float]]:
        height, width = self.shape
        depth = 0.0 if self.distance_radii is None else -self.focal_px
        return [(np.array([x - width / 2, height / 2 - y, depth]), radius) for x, y, radius in self.balls]

    def _rays(self, x: F64, y: F64) -> tuple[F64, F64]:
        across, up = x - self.shape[1] / 2, self.shape[0] / 2 - y
        if self.distance_radii is None:
            return np.stack([across, up, np.full_like(x, 1e3)], -1), np.tile([0.0, 0.0, -1.0], (*x.shape, 1))
        ray = np.stack([across, up, np.full_like(x, -self.focal_px)], -1)
        return np.zeros_like(ray), ray / np.linalg.norm(ray, axis=-1, keepdims=True)

    def _room(self, ways: F64, light: F64, index: int, strength: float, grey: float) -> F64:
        """What comes from these directions: a dim room with a window, the lit table below, the lamp."""
        seen = 0.004 + 0.02 * np.clip(ways[:, 1], 0, 1)
        seen = np.where(ways[:, 2] < -0.2, grey * (0.15 + strength * max(light[2], 0)), seen)
        window = np.array([-0.75, 0.3, 0.59])
        seen = np.where(ways @ (window / np.linalg.norm(window)) > np.cos(np.radians(7)), self.window, seen)
        lit = ways @ light > np.cos(np.radians(self.lamp_deg))
        if index in self.second:
            second = np.array(self.second[index]) / np.linalg.norm(self.second[index])
            lit |= ways @ second > np.cos(np.radians(self.lamp_deg))
        return np.where(lit & (strength > 0), self.lamp, seen)
