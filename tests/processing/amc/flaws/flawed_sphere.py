"""Slices of a covered sphere that is not as it should be: cut, folded, woven, seen by a camera with hot pixels.

Orthographic slices are shaded at the table's own normals by a few lines that share nothing with what is tested. What
sticks to the sample is a function of the place on it, (x, y) in the frame of slice 0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
Place = Callable[[F64, F64], F64]

FINE = 4


@dataclass(frozen=True)
class Material:
    """A gloss that repeats R times a turn; 0 is isotropic. A higher sharpness makes narrower highlights."""

    repeats: int = 2
    sharpness: float = 1.0
    gloss: float = 0.8
    light_seed: int = 0


def normals(size: int) -> F64:
    """Unit normals (S, S, 3) at the texels' centres; beyond the disc, those of the rim."""
    line = (2 * np.arange(size) + 1) / size - 1
    n_x, n_y = np.meshgrid(line, -line)
    radius = np.maximum(np.hypot(n_x, n_y), 1e-9)
    inside = np.minimum(radius, 0.999)
    return np.stack([n_x / radius * inside, n_y / radius * inside, np.sqrt(1 - inside**2)], axis=-1)


def disc(size: int, radius: float = 0.98) -> Mask:
    line = (2 * np.arange(size) + 1) / size - 1
    return np.asarray(np.hypot(*np.meshgrid(line, line)) < radius)


def lights(seed: int) -> tuple[F64, F64]:
    """Directions (L, 3), the first few of them never below 20 degrees, and colours (L, 3)."""
    random = np.random.default_rng(1000 + seed)
    azimuth = np.arange(4) * 1.7 + random.uniform(0, 6, 4)
    height = random.uniform(0.35, 0.95, 4)
    flat = np.sqrt(1 - height**2)
    directions = np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), height], axis=-1)
    return directions, random.uniform(0.2, 0.8, (4, 1)) * random.uniform(0.7, 1.0, (4, 3))


def lambert(size: int, seed: int) -> F64:
    """The part of the light that does not shine (S, S, 3)."""
    directions, colours = lights(seed)
    return np.asarray(0.02 + 0.18 * np.maximum(normals(size) @ directions.T, 0) @ colours)


def gloss(material: Material, size: int, taus_rad: F64) -> F64:
    """The part that shines (N, S, S, 3)."""
    normal = normals(size)
    directions, colours = lights(material.light_seed)
    total = np.zeros((len(taus_rad), size, size, 3))
    for direction, colour in zip(directions, colours, strict=True):
        half = direction + np.array([0, 0, 1])
        half /= np.linalg.norm(half)
        facing = np.maximum(normal @ direction, 0)[..., None] * colour
        for slice_, tau in zip(total, taus_rad, strict=True):
            slice_ += material.gloss * facing * _lobes(material, half, normal, float(tau))[..., None]
    return total


@cache
def clean(material: Material, size: int, taus_rad: tuple[float, ...]) -> F32:
    """Slices (N, S, S, 3) without noise or flaw; do not write into them."""
    shining = gloss(material, size, np.array(taus_rad)) + lambert(size, material.light_seed)
    return np.asarray(shining, np.float32)


def _lobes(material: Material, half: F64, normal: F64, tau: float) -> F64:
    narrow, wide = 0.18 / material.sharpness, 0.5
    if material.repeats == 0:
        return _ward(half, normal, tau, 0.25, 0.25)
    if material.repeats in (2, 4):
        crossed = range(material.repeats // 2)
        return np.asarray(sum(_ward(half, normal, tau + i * np.pi / 2, narrow, wide) for i in crossed) / len(crossed))
    spokes = tau + np.arange(material.repeats) * 2 * np.pi / material.repeats
    return np.asarray(sum(_tilted(half, normal, spoke, 0.3 / material.sharpness) for spoke in spokes) / len(spokes))


def _tangent(normal: F64, tau: float) -> F64:
    """The tangent whose picture points along tau, as (S, S, 3) unit vectors."""
    axis = np.broadcast_to([-np.sin(tau), np.cos(tau), 0.0], normal.shape)
    tangent = np.cross(axis, normal)
    return np.asarray(tangent / np.linalg.norm(tangent, axis=-1, keepdims=True))


def _ward(half: F64, normal: F64, tau: float, along: float, across: float) -> F64:
    tangent = _tangent(normal, tau)
    upright = np.maximum(normal @ half, 1e-3)
    slopes = (tangent @ half / along) ** 2 + (np.cross(normal, tangent) @ half / across) ** 2
    return np.asarray(np.exp(-slopes / upright**2))


def _tilted(half: F64, normal: F64, tau: float, rough: float) -> F64:
    leaning = normal + 0.3 * _tangent(normal, tau)
    cosine = leaning @ half / np.linalg.norm(leaning, axis=-1)
    return np.asarray(np.exp(-((1 - cosine) * 2) / rough**2))


def seen(place: Place, size: int, turn_rad: float) -> F64:
    """What a slice sees of a function of the place on the sample, averaged over each texel; (S, S)."""
    line = (2 * np.arange(size * FINE) + 1) / (size * FINE) - 1
    x, y = np.meshgrid(line, -line)
    cosine, sine = np.cos(turn_rad), np.sin(turn_rad)
    values = np.asarray(place(cosine * x + sine * y, cosine * y - sine * x), float)
    return np.asarray(values.reshape(size, FINE, size, FINE).mean(axis=(1, 3)))


def seen_all(place: Place, size: int, turns_rad: F64) -> F32:
    return np.stack([seen(place, size, float(turn)).astype(np.float32) for turn in turns_rad])


def line_cut(angle_rad: float, offset: float, width: float, inner: float = 0.0, outer: float = 1.0) -> Place:
    """A straight cut along a direction, beside the centre by an offset, between two radii."""

    def place(x: F64, y: F64) -> F64:
        along = np.cos(angle_rad) * x + np.sin(angle_rad) * y
        beside = np.abs(np.cos(angle_rad) * y - np.sin(angle_rad) * x - offset)
        radius = np.hypot(x, y)
        return np.asarray((beside < width / 2) & (along > 0) & (radius > inner) & (radius < outer), float)

    return place


def wedge(angle_rad: float, opening_rad: float, tip: float) -> Place:
    """A dart from the rim to a tip."""

    def place(x: F64, y: F64) -> F64:
        beside = np.abs(np.angle(np.exp(1j * (np.arctan2(y, x) - angle_rad))))
        reach = np.hypot(x, y) - tip
        return np.asarray(beside < opening_rad / 2 * np.clip(reach / (1 - tip), 0, 1), float)

    return place


def arc_seam(x_0: float, y_0: float, radius: float, width: float) -> Place:
    """A seam along a circle about some place."""
    return lambda x, y: np.asarray(np.abs(np.hypot(x - x_0, y - y_0) - radius) < width / 2, float)


def weave(period: float, contrast: float, angle_rad: float = 0.3) -> Place:
    """Threads over and under in both directions, as a factor with mean 1."""

    def place(x: F64, y: F64) -> F64:
        u = np.cos(angle_rad) * x + np.sin(angle_rad) * y
        v = np.cos(angle_rad) * y - np.sin(angle_rad) * x
        return np.asarray(1 + contrast * np.sin(2 * np.pi * u / period) * np.sin(2 * np.pi * v / period))

    return place


def blotches(seed: int, scale: float, contrast: float) -> Place:
    """Random even texture, as felt has it: a sum of 16 waves, as a factor with mean 1."""
    random = np.random.default_rng(seed)
    waves = random.normal(0, 2 * np.pi / scale / np.sqrt(2), (16, 2))
    phases = random.uniform(0, 2 * np.pi, 16)

    def place(x: F64, y: F64) -> F64:
        total = sum(np.sin(u * x + v * y + phase) for (u, v), phase in zip(waves, phases, strict=True))
        return np.asarray(1 + contrast * total / np.sqrt(8))

    return place
