"""Light probes and heights for the scenes of the Shape paper, of our own making.

Probes are (H, 2H, 3) float32 in mitsuba's layout, y up.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from firmware_sim.mitsuba.lighting import map_directions

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
ROWS = 128

# Direction, sharpness, radiance.
_GLOWS = (
    ((-0.6, 0.7, 0.6), 14.0, (2.6, 2.3, 1.8)),
    ((0.8, 0.2, 0.4), 7.0, (0.5, 0.75, 1.2)),
    ((0.1, 0.3, -1.0), 5.0, (0.7, 0.5, 0.9)),
)
_WALL, _CEILING, _GROUND = (0.10, 0.08, 0.06), (0.16, 0.155, 0.15), (0.05, 0.03, 0.02)
# Azimuth of the middle from +x towards +z and half a width, lowest and highest elevation, in degrees; radiance.
_WINDOWS = (
    ((115, 22), (10, 60), (4.2, 4.6, 5.2)),
    ((25, 14), (-5, 40), (2.6, 1.6, 0.6)),
    ((200, 30), (15, 35), (0.5, 1.1, 0.7)),
    ((290, 25), (-10, 55), (1.3, 1.2, 1.6)),
)
_BAR_DEG = 2.0


def soft() -> F32:
    """Return a hazy sky with three glows."""
    directions = map_directions(ROWS)
    radiance = np.full(directions.shape, 0.08) + 0.25 * (0.5 + 0.5 * directions[..., 1:2]) * np.array([0.7, 0.85, 1.0])
    for middle, sharpness, colour in _GLOWS:
        cosine = directions @ (np.array(middle) / np.linalg.norm(middle))
        radiance += np.exp(sharpness * (cosine - 1))[..., None] * np.array(colour)
    return np.asarray(radiance, np.float32)


def windows() -> F32:
    """Return a room with four windows of hard edges, each with a cross of bars."""
    directions = map_directions(ROWS)
    elevation = np.degrees(np.arcsin(np.clip(directions[..., 1], -1, 1)))
    azimuth = np.degrees(np.arctan2(directions[..., 2], directions[..., 0]))
    radiance = np.where(elevation[..., None] > 62, _CEILING, np.where(elevation[..., None] < -18, _GROUND, _WALL))
    for (middle, half), (low, high), colour in _WINDOWS:
        away = (azimuth - middle + 180) % 360 - 180
        inside = (np.abs(away) < half) & (elevation > low) & (elevation < high)
        bars = (np.abs(away) < _BAR_DEG) | (np.abs(elevation - (low + high) / 2) < _BAR_DEG)
        radiance = np.where((inside & ~bars)[..., None], colour, radiance)
    return np.asarray(radiance, np.float32)


PROBES = {"soft": soft, "windows": windows}


@cache
def cells(across: int, up: int, size: int = 512, seed: int = 5) -> F32:
    """Return heights (size, size, 1) from 0 to 1 that repeat: flat hills over Voronoi cells, round valleys between."""
    random = np.random.default_rng(seed)
    middles = (np.stack(np.meshgrid(np.arange(across), np.arange(up)), axis=-1) + 0.5).reshape(-1, 2)
    middles = middles + random.uniform(-0.35, 0.35, middles.shape)
    around = np.array([(i * across, j * up) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    tree = cKDTree((middles[:, None] + around).reshape(-1, 2))
    along = (np.arange(size) + 0.5) / size
    places = np.stack(np.meshgrid(along * across, along * up), axis=-1)
    near, next_to_it = np.moveaxis(tree.query(places, k=2)[0], -1, 0)
    rise: F64 = np.clip((next_to_it - near) / 0.7, 0, 1)
    return (rise * rise * (3 - 2 * rise))[..., None].astype(np.float32)
