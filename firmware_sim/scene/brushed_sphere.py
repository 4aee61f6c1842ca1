"""A sphere of brushed aluminium that turns about the camera's axis.

It is brushed along parallels about an axis that lies in the image plane, so that the tangent a × n at every place has
the same direction in the picture, and half a turn brings the same material back. Each pixel is shaded with its own ray
and normal. The microfacets are GGX with two roughnesses (Walter et al. 2007, Burley 2012) and the visibility term of
Kelemen and Szirmay-Kalos (2001), 1 / (4 (l·h)²), which does not depend on the tangent.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from firmware_sim.config import SphereScene
from firmware_sim.scene.pose import F32, Pose, Size

REFERENCE_HEIGHT = 480
"""The picture height that pixel figures in the configuration refer to."""
ALUMINIUM = np.array([0.913, 0.922, 0.924], np.float32)
BACKGROUND_SEED = 5
STEPS = 72
STEP_DEG = 180 / STEPS
"""Spacing of the angles between which a moving sphere is interpolated, small against the width of its highlights."""


@dataclass(frozen=True)
class SoftLight:
    """A distant disc of light in the view frame.

    Attributes
    ----------
    direction : from the sample to the disc's middle, any length
    radius_deg : angular radius
    rings : of directions that stand for it, besides the middle
    colour : (3,) linear RGB
    """

    direction: tuple[float, float, float]
    radius_deg: float
    rings: int
    colour: tuple[float, float, float]

    def samples(self) -> tuple[F32, F32]:
        """Return unit directions (L, 3) that share the light evenly, and their colours (L, 3)."""
        middle = np.array(self.direction) / np.linalg.norm(self.direction)
        side = np.cross(middle, [0.0, 0.0, 1.0] if abs(middle[2]) < 0.9 else [1.0, 0.0, 0.0])
        side /= np.linalg.norm(side)
        up = np.cross(middle, side)
        directions = [middle]
        for ring in range(1, self.rings + 1):
            tilt = math.radians(self.radius_deg) * ring / self.rings
            for angle in np.arange(6 * ring) * math.tau / (6 * ring):
                across = math.cos(angle) * side + math.sin(angle) * up
                directions.append(math.cos(tilt) * middle + math.sin(tilt) * across)
        colours = np.tile(np.array(self.colour) / len(directions), (len(directions), 1))
        return np.array(directions, np.float32), colours.astype(np.float32)


KEY = SoftLight((-0.55, 0.65, 0.75), 16, 2, (1.10, 1.02, 0.90))
FILL = SoftLight((0.85, 0.10, 0.65), 14, 1, (0.24, 0.29, 0.36))
RIM = SoftLight((0.35, -0.85, 0.12), 14, 1, (0.62, 0.50, 0.40))
BACK = SoftLight((-0.80, -0.35, 0.05), 12, 1, (0.24, 0.34, 0.50))
LIGHTS = (KEY, FILL, RIM, BACK)


class BrushedSphere:
    """The scene; what depends on the picture's size alone is kept from frame to frame."""

    def __init__(self, config: SphereScene) -> None:
        self._config = config
        self._shaders: dict[Size, _Shader] = {}

    def is_ready(self, pose: Pose, size: Size) -> bool:
        return True

    def light(self, poses: Sequence[Pose], size: Size) -> F32:
        if size not in self._shaders:
            self._shaders = {size: _Shader(self._config, size)}
        shader = self._shaders[size]
        angles_deg = [pose.turntable_deg + self._config.tangent_zero_deg for pose in poses]
        if len(angles_deg) == 1:
            return shader.picture(shader.shade(math.radians(angles_deg[0])))
        return shader.picture(shader.shade_between(angles_deg))


class _Shader:
    """All that a turn leaves as it is, for one picture size.

    With the half vector h, the lobe depends on the turn through (h·t)² alone, since (h·t)² + (h·b)² = 1 − (h·n)². And
    h·t = a·(n × h) / |a × n|, where the brushing axis a is the only thing that turns.
    """

    def __init__(self, config: SphereScene, size: Size) -> None:
        across, along = config.roughness_across, config.roughness_along
        self._size = size
        self._background = _background(size)
        radii = _radii_from_centre(config, size)
        radius_px = config.radius_px * size[0] / REFERENCE_HEIGHT
        off = np.hypot(*radii)
        self._inside = off < 1 + 0.5 / radius_px
        # Half a pixel on either side of the outline, the sphere covers its pixels in part.
        self._coverage = np.clip((1 - off[self._inside]) * radius_px + 0.5, 0, 1).astype(np.float32)[:, None]
        shrink = np.minimum(1, 0.9999 / np.maximum(off[self._inside], 1e-9))
        x, y = (axis[self._inside] * shrink for axis in radii)
        self._normals, views = _normals_and_views(config, x, y)
        directions, self._colours = (
            np.concatenate(parts) for parts in zip(*(light.samples() for light in LIGHTS), strict=True)
        )
        self._stretch = np.float32(1 / along**2 - 1 / across**2)
        self._halves = [_Half(self._normals, views, direction, along, across) for direction in directions]
        self._ambient = _ambient(self._normals, views)
        self._kept: dict[int, NDArray[np.float16]] = {}

    def shade(self, angle_rad: float) -> F32:
        """Shade with the brushing axis turned by an angle, counter-clockwise, from straight up: (N, 3)."""
        axis = np.array([-math.sin(angle_rad), math.cos(angle_rad)], np.float32)
        n = self._normals
        # |a × n|² vanishes at the poles of the brushing, where all directions meet.
        stretch = self._stretch / np.maximum(1 - (n[:, 0] * axis[0] + n[:, 1] * axis[1]) ** 2, np.float32(1e-6))
        lobes = np.stack([half.lobe(axis, stretch) for half in self._halves])
        return np.asarray((lobes.T @ self._colours) * ALUMINIUM + self._ambient, np.float32)

    def shade_between(self, angles_deg: Sequence[float]) -> F32:
        """Return the mean shade at some angles, by interpolation between angles that are kept once they were met."""
        weights: dict[int, float] = defaultdict(float)
        for angle_deg in angles_deg:
            place = angle_deg % 180 / STEP_DEG  # half a turn is a whole period
            before, part = int(place), place % 1
            weights[before % STEPS] += (1 - part) / len(angles_deg)
            weights[(before + 1) % STEPS] += part / len(angles_deg)
        mean = np.zeros_like(self._ambient)
        for step, weight in weights.items():
            if step not in self._kept:
                self._kept[step] = self.shade(math.radians(step * STEP_DEG)).astype(np.float16)
            mean += self._kept[step] * np.float32(weight)
        return mean

    def picture(self, shade: F32) -> F32:
        """Put the shaded sphere before the background: (H, W, 3)."""
        picture = self._background.copy()
        picture[self._inside] += self._coverage * (shade - picture[self._inside])
        return picture


class _Half:
    """One light's half vectors over the sphere."""

    def __init__(self, normals: F32, views: F32, direction: F32, along: float, across: float) -> None:
        half = views + direction
        half /= np.linalg.norm(half, axis=1, keepdims=True)
        facing = np.einsum("ij,ij->i", normals, half)
        incidence = np.maximum(normals @ direction, 0)
        visibility = 1 / (4 * np.maximum(half @ direction, 1e-3) ** 2)
        cross = np.cross(normals, half)
        self._cross_x, self._cross_y = (np.ascontiguousarray(cross[:, i], np.float32) for i in (0, 1))
        self._base = ((1 - facing**2) / across**2 + facing**2).astype(np.float32)
        self._weight = (incidence * visibility / (math.pi * along * across)).astype(np.float32)

    def lobe(self, axis: F32, stretch: F32) -> F32:
        """Return reflected light for each pixel, for light of unit irradiance."""
        dot = axis[0] * self._cross_x + axis[1] * self._cross_y
        spread = dot * dot * stretch + self._base
        result: F32 = self._weight / (spread * spread)
        return result


def _radii_from_centre(config: SphereScene, size: Size) -> tuple[F32, F32]:
    """Return x right and y up of every pixel's middle, in radii of the sphere's picture: two (H, W) arrays."""
    height, width = size
    scale = height / REFERENCE_HEIGHT
    centre_x = width / 2 + (config.centre_x_px - 320) * scale
    centre_y = height / 2 + (config.centre_y_px - 240) * scale
    columns, rows = np.arange(width) + 0.5, np.arange(height) + 0.5
    x, y = np.meshgrid((columns - centre_x), (centre_y - rows))
    radius = config.radius_px * scale
    return (x / radius).astype(np.float32), (y / radius).astype(np.float32)


def _normals_and_views(config: SphereScene, x: F32, y: F32) -> tuple[F32, F32]:
    """Meet every pixel's ray with the sphere: unit normals and unit directions to the camera, (N, 3) each."""
    if config.projection == "orthographic":
        normals = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=1)
        return normals.astype(np.float32), np.broadcast_to(np.array([0, 0, 1], np.float32), normals.shape).copy()
    distance = config.distance_radii
    outline = math.tan(math.asin(1 / distance))
    rays = np.stack([x * outline, y * outline, np.full_like(x, -1)], axis=1).astype(np.float64)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    along = -distance * rays[:, 2]
    reach = along - np.sqrt(np.maximum(along**2 - (distance**2 - 1), 0))
    normals = np.array([0, 0, distance]) + reach[:, None] * rays
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals, np.float32), np.asarray(-rays, np.float32)


def _ambient(normals: F32, views: F32) -> F32:
    """Return what the dim surroundings reflect, brighter from above: (N, 3)."""
    facing = np.einsum("ij,ij->i", normals, views)[:, None]
    mirrored_y = (2 * facing * normals - views)[:, 1:2]
    amount = 0.012 + 0.028 * np.clip(0.5 + 0.5 * mirrored_y, 0, 1) ** 2
    return np.asarray(amount * np.array([0.85, 0.95, 1.1]) * ALUMINIUM, np.float32)


def _background(size: Size) -> F32:
    """Return a dark, woven cloth that lies still: (H, W, 3)."""
    height, width = size
    scale = height / REFERENCE_HEIGHT
    noise = np.random.default_rng(BACKGROUND_SEED).standard_normal((height, width)).astype(np.float32)
    threads = cv2.GaussianBlur(noise, (0, 0), 0.7 * scale) + 2 * cv2.GaussianBlur(noise, (0, 0), 6 * scale)
    rows, columns = np.mgrid[0:height, 0:width] / height
    vignette = np.exp(-2.2 * ((columns - 0.5 * width / height) ** 2 + (rows - 0.45) ** 2))
    level = 0.010 * (0.35 + vignette) * (1 + 0.35 * threads)
    return np.asarray(np.clip(level[..., None] * np.array([0.9, 1.0, 1.25]), 0, None), np.float32)
