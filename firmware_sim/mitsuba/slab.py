"""A bumpy slab of two-coloured stone: domes, a groove, ripples and grain, as the vertices of a mesh."""

import functools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_sim.scene.pose import F32

VERTICES_A_SIDE = 289
HALF_SIDE = 2.4
"""In radii of the sphere: wide enough that it fills a picture of 640 × 480 however it is turned."""
LIGHT_STONE, DARK_STONE = (0.78, 0.66, 0.50), (0.42, 0.30, 0.24)
F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]


class SlabMesh(NamedTuple):
    """What the mesh consists of.

    Attributes
    ----------
    positions : (V, 3) float32, the slab's middle plane at z = 0
    normals : (V, 3) float32, unit
    texture_places : (V, 2) float32, where in the picture of colours a vertex lies, 0..1
    colours : (N, N, 3) float32, diffuse reflectance; row 0 at y = −2.4
    faces : (F, 3) uint32, counter-clockwise as the camera sees them
    """

    positions: F32
    normals: F32
    texture_places: F32
    colours: F32
    faces: U32


@functools.cache
def slab_mesh() -> SlabMesh:
    """Return the slab as it lies at turntable zero; all share it, and nobody writes into it."""
    line = np.linspace(-HALF_SIDE, HALF_SIDE, VERTICES_A_SIDE)
    x, y = np.meshgrid(line, line)
    heights = slab_heights(x, y)
    stain = np.clip(0.5 + 1.2 * _ripples(x, y, 2.1, 5), 0, 1)[..., None]
    colours = stain * np.array(LIGHT_STONE) + (1 - stain) * np.array(DARK_STONE)
    positions = np.stack([x, y, heights], axis=-1)
    places = np.stack([x, y], axis=-1) / (2 * HALF_SIDE) + 0.5
    return SlabMesh(
        positions=positions.reshape(-1, 3).astype(np.float32),
        normals=_grid_normals(heights).reshape(-1, 3),
        texture_places=places.reshape(-1, 2).astype(np.float32),
        colours=colours.astype(np.float32),
        faces=_grid_faces(),
    )


def slab_heights(x: F64, y: F64) -> F64:
    """Return the height above the slab's middle plane, in radii, smooth but for the domes' feet."""
    domes = np.zeros_like(x)
    for i in range(7):
        angle = math.tau * i / 6
        off = 0.62 if i < 6 else 0.0
        near = 1 - ((x - off * math.cos(angle)) ** 2 + (y - off * math.sin(angle)) ** 2) / 0.2**2
        domes = np.maximum(domes, 0.16 * np.sqrt(np.maximum(near, 0)))
    groove = -0.07 * np.exp(-(((np.hypot(x, y) - 1.0) / 0.05) ** 2))
    return np.asarray(domes + groove + 0.035 * _ripples(x, y, 4.0, 3) + 0.006 * _ripples(x, y, 22.0, 4))


def _grid_normals(heights: F64) -> F32:
    spacing = 2 * HALF_SIDE / (VERTICES_A_SIDE - 1)
    along_y, along_x = np.gradient(heights, spacing)
    normals = np.stack([-along_x, -along_y, np.ones_like(heights)], axis=-1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True), np.float32)


def _ripples(x: F64, y: F64, waves: float, seed: int) -> F64:
    """Return a sum of plane waves of one length and random ways, RMS about 0.5."""
    random = np.random.default_rng(seed)
    total = np.zeros_like(x)
    for angle, phase in random.uniform(0, math.tau, (8, 2)):
        total += np.sin(waves * (x * math.cos(angle) + y * math.sin(angle)) + phase) / 5.6
    return total * 2


def _grid_faces() -> U32:
    first = np.arange(VERTICES_A_SIDE - 1)
    corner = (first[:, None] * VERTICES_A_SIDE + first[None, :]).ravel()
    right, up, across = corner + 1, corner + VERTICES_A_SIDE, corner + VERTICES_A_SIDE + 1
    faces = np.concatenate([np.stack([corner, right, across], 1), np.stack([corner, across, up], 1)])
    return faces.astype(np.uint32)
