"""A brushed metal under five lamps, as a formula: an AMC whose every texel is known."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal
from processing.amc.model import Amc, Invariance

F64 = NDArray[np.float64]

_LAMPS: tuple[tuple[tuple[float, float, float], tuple[float, float, float], float], ...] = (
    ((-0.55, 0.62, 0.56), (1.0, 0.93, 0.82), 0.55),
    ((0.70, 0.25, 0.67), (0.75, 0.86, 1.0), 0.40),
    ((0.10, -0.80, 0.59), (0.85, 0.75, 0.95), 0.22),
    ((-0.85, -0.20, 0.49), (0.70, 0.85, 1.0), 0.25),
    ((0.15, 0.90, 0.41), (1.0, 0.96, 0.88), 0.35),
)
_METAL = np.array([0.95, 0.90, 0.82])


def disc_normals(size: int) -> tuple[F64, NDArray[np.bool_]]:
    """Normals (S, S, 3) at texel centres, row 0 at n_y = +1; past the disc those of its rim, and what lies inside."""
    along = (2 * np.arange(size) + 1) / size - 1
    x, y = np.meshgrid(along, -along)
    radius = np.hypot(x, y)
    shrink = np.minimum(1, 0.999 / np.maximum(radius, 1e-9))
    x, y = x * shrink, y * shrink
    return np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1), radius < 1


def brushed(
    normals: F64, tangent_angle_rad: float, folds: int = 2, roughness: tuple[float, float] = (0.5, 0.16)
) -> F64:
    """Linear colour of Ward-like streaks; `folds` is how often they repeat in a turn of the tangent."""
    cosine, sine = math.cos(tangent_angle_rad), math.sin(tangent_angle_rad)
    tangents = np.stack([normals[..., 2] * cosine, normals[..., 2] * sine], axis=-1)
    tangents = np.concatenate([tangents, -(normals[..., :1] * cosine + normals[..., 1:2] * sine)], axis=-1)
    tangents /= np.linalg.norm(tangents, axis=-1, keepdims=True)
    crossing = np.cross(normals, tangents)
    colours: F64 = np.full(normals.shape, 0.02) * _METAL
    for direction, tint, power in _LAMPS:
        light = np.array(direction) / np.linalg.norm(direction)
        half = (light + np.array([0.0, 0.0, 1.0])) / np.linalg.norm(light + np.array([0.0, 0.0, 1.0]))
        along, across, up = tangents @ half, crossing @ half, np.maximum(normals @ half, 1e-3)
        turn = np.arctan2(across, along)
        lean = (along**2 + across**2) / up**2
        # Between the two widths by the angle to the grain, as often round a turn as asked.
        sharpness = (1 - np.cos(folds * turn)) / 2
        width = 1 / (sharpness / roughness[1] ** 2 + (1 - sharpness) / roughness[0] ** 2)
        lit = np.clip(normals @ light + 0.15, 0, None)
        colours += (power * np.exp(-lean / width) * lit**0.5 + 0.05 * power * lit)[..., None] * np.array(tint) * _METAL
    return colours


def brushed_amc(
    size: int = 64,
    depth: int = 64,
    invariance: Invariance = 2,
    table_normal: TableNormal = TableNormal.RECTIFIED,
    roughness: tuple[float, float] = (0.5, 0.16),
) -> Amc:
    """The material as an AMC; one that is invariant to 360°/R has streaks that repeat R times a turn."""
    normals, valid = disc_normals(size)
    folds = 0 if invariance == "isotropic" else invariance
    turns = np.arange(depth) / depth / max(folds, 1)
    slices = np.stack([brushed(normals, 2 * math.pi * turn, folds, roughness) for turn in turns])
    return Amc(slices.astype(np.float32), np.repeat(valid[None], depth, axis=0), invariance, table_normal)
