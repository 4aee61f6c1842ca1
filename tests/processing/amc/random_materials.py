"""Random materials in random light, shaded at the table's own normals: what a perfect camera would see of a turn."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.amc.geometry import texel_plane
from tests.processing.amc.brushed_sphere import encode, tangent_at

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Trial:
    """A noisy turn, and what is true of it.

    Attributes
    ----------
    kind : R, or "isotropic"
    slices : (N, S, S, 3) float32, linear light of noisy codes of 8 bits
    energy_over_noise : energy of the change over the turn in units of the noise's, away from the rim
    variation : RMS change over the turn by the RMS of the mean, without noise
    """

    kind: int | str
    slices: NDArray[np.float32]
    valid: NDArray[np.bool_]
    angles_rad: F64
    energy_over_noise: float
    variation: float


def make_trial(kind: int | str, seed: int, *, slices: int | None = None, size: int = 26) -> Trial:
    random = np.random.default_rng(seed)
    count = slices or int(random.choice([24, 32, 48, 64]))
    n_x, n_y = texel_plane(size)
    valid = np.hypot(n_x, n_y) < 0.98
    normals = np.stack([n_x, n_y, np.sqrt(np.maximum(1 - n_x**2 - n_y**2, 0))], axis=-1)[valid]
    angles = 2 * np.pi * (np.arange(count) + 0.1 * random.uniform(-1, 1, count)) / count
    shade = _material(kind, random)
    light = np.stack([shade(normals, tangent_at(normals, float(np.degrees(angle)))) for angle in angles])
    light *= random.uniform(0.5, 0.95) / np.quantile(light, 0.999)
    sigma = float(np.exp(random.uniform(np.log(0.0005), np.log(0.03))))
    codes = np.rint(encode(light + sigma * random.standard_normal(light.shape)) * 255) / 255
    noisy = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    clean = np.clip(light, 0, 1)
    inner = np.hypot(n_x, n_y)[valid] <= 0.9
    noise = float(np.mean((noisy - clean)[:, inner] ** 2))
    mean = clean[:, inner].mean(axis=0)
    change = float(np.mean((clean[:, inner] - mean) ** 2))
    table = np.zeros((count, size, size, 3), np.float32)
    table[:, valid] = noisy
    return Trial(kind, table, valid, angles, change / noise, float(np.sqrt(change / np.mean(mean**2))))


def _material(kind: int | str, random: np.random.Generator) -> Callable[[F64, F64], F64]:
    """Gloss of one or more lobes over a diffuse share, under one to five distant lights."""
    lights = random.normal((0, 0, 1), 1, (int(random.integers(1, 6)), 3))
    lights /= np.linalg.norm(lights, axis=1, keepdims=True)
    colours = random.uniform(0.1, 1, (len(lights), 3))
    diffuse = random.uniform(0.02, 0.4)
    narrow, wide = random.uniform(0.12, 0.25), random.uniform(0.35, 0.8)
    tilt = random.uniform(0.2, 0.5)

    def lobes(half: F64, normal: F64, tangent: F64) -> F64:
        if kind == "isotropic":
            return _lobe(half, normal, tangent, narrow, narrow)
        if kind == 2:
            return _lobe(half, normal, tangent, narrow, wide)
        if kind == 4:
            across = np.cross(normal, tangent)
            return _lobe(half, normal, tangent, narrow, wide) + _lobe(half, normal, across, narrow, wide)
        total = np.zeros(len(half))
        for spoke in range(int(kind)):
            turn = 2 * np.pi * spoke / int(kind)
            direction = np.cos(turn) * tangent + np.sin(turn) * np.cross(normal, tangent)
            tilted = normal + tilt * direction
            tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
            total += _lobe(half, tilted, np.cross(tilted, np.cross(direction, tilted)), narrow, narrow)
        return total

    def shade(normal: F64, tangent: F64) -> F64:
        light = np.full((len(normal), 3), 0.02)
        for direction, colour in zip(lights, colours, strict=True):
            half = direction + np.array([0.0, 0.0, 1.0])
            half = np.broadcast_to(half / np.linalg.norm(half), normal.shape)
            facing = np.maximum(normal @ direction, 0)
            light += (facing * (diffuse + lobes(half, normal, tangent)))[:, None] * colour
        return light

    return shade


def _lobe(half: F64, normal: F64, tangent: F64, rough_t: float, rough_b: float) -> F64:
    """Ward's anisotropic exponential."""
    along = np.sum(half * tangent, axis=1) / rough_t
    across = np.sum(half * np.cross(normal, tangent), axis=1) / rough_b
    upright = np.maximum(np.sum(half * normal, axis=1), 1e-3)
    return np.asarray(np.exp(-(along**2 + across**2) / upright**2))
