"""Two balls in light that is a formula, seen in perspective, with all buffers known; and bumps to put on them."""

import numpy as np
from numpy.typing import NDArray

from processing.paraboloid.maps import texel_directions
from processing.shape import harmonics
from processing.shape.model import Environments, ShadingBuffers, SurfaceEnvironment
from tests.processing.matcap.maps import sharp, soft

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
SIZE = (150, 120)
BALLS = {2: ((-0.55, 0.05, -4.0), 0.8), 7: ((0.75, -0.2, -4.6), 0.75)}
"""Middle and radius by the number of the surface."""
TINT = {2: 1.0, 7: 0.5}
_FOCAL_PX = 240.0


def diffuse_coefficients(number: int) -> F32:
    """Shading that the harmonics hold exactly, positive everywhere."""
    some = np.random.default_rng(number).uniform(-0.12, 0.12, (9, 3))
    some[0] = 2.2 * TINT[number]
    return some.astype(np.float32)


def environments(size: int = 96) -> Environments:
    front, back = texel_directions(size)
    return {
        number: SurfaceEnvironment(
            diffuse_coefficients(number),
            (sharp(front) * TINT[number]).astype(np.float32),
            (sharp(back) * TINT[number]).astype(np.float32),
        )
        for number in BALLS
    }


def buffers() -> ShadingBuffers:
    """Render by rays; occlusion darkens towards the bottom, and what is covered half is half background."""
    width, height = SIZE
    x, y = np.meshgrid(
        (np.arange(width) + 0.5 - width / 2) / _FOCAL_PX, -(np.arange(height) + 0.5 - height / 2) / _FOCAL_PX
    )
    rays = np.stack([x, y, -np.ones_like(x)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    normals, positions = np.zeros(rays.shape), np.zeros(rays.shape)
    surfaces = np.zeros(x.shape, np.uint32)
    nearest = np.full(x.shape, np.inf)
    for number, (middle, radius) in BALLS.items():
        along = rays @ np.array(middle)
        inside = along**2 - np.sum(np.square(middle)) + radius**2
        distance = along - np.sqrt(np.maximum(inside, 0))
        seen = (inside > 0) & (distance < nearest)
        nearest[seen] = distance[seen]
        positions[seen] = (rays * distance[..., None])[seen]
        normals[seen] = ((positions - np.array(middle)) / radius)[seen]
        surfaces[seen] = number
    shown = surfaces > 0
    occlusion = np.where(shown, np.clip(0.7 + 0.5 * normals[..., 1], 0, 1), 1)
    coverage = np.where(shown, 1 - 0.5 * (normals[..., 2] < 0.25), 0)
    diffuse, reflection = np.zeros(rays.shape), np.zeros(rays.shape)
    mirrored = 2 * np.sum(normals * -rays, axis=-1, keepdims=True) * normals + rays
    for number, environment in environments(4).items():
        here = surfaces == number
        lit = harmonics.evaluate(normals[here]) @ environment.diffuse
        diffuse[here] = lit * occlusion[here][:, None]
        reflection[here] = sharp(mirrored[here]) * TINT[number] * occlusion[here][:, None]
    background = soft(rays * np.array([1, 1, -1]))
    picture = background + coverage[..., None] * (diffuse + reflection - background)
    floats = (picture, coverage, diffuse, reflection, normals, positions)
    root, alpha, d0, r0, n, p = (values.astype(np.float32) for values in floats)
    return ShadingBuffers(
        root, alpha, d0, r0, n, p, surfaces, occlusion.astype(np.float32), (occlusion**2).astype(np.float32)
    )


def bumped(normals: F32, strength: float = 0.25) -> F32:
    """Add a wave to normals inside a square, and leave those outside bit by bit."""
    height, width = normals.shape[:2]
    rows, columns = np.indices((height, width))
    inside = (rows > 25) & (rows < 95) & (columns > 30) & (columns < 120) & (np.linalg.norm(normals, axis=-1) > 0)
    wave = np.stack([np.sin(columns / 4.0), np.cos(rows / 5.0), np.zeros((height, width))], axis=-1) * strength
    changed = normals + wave
    changed /= np.linalg.norm(changed, axis=-1, keepdims=True)
    return np.where(inside[..., None], changed, normals).astype(np.float32)
