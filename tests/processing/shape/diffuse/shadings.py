"""Diffuse shading of made-up surfaces: much and little of the sphere, occluded or not, one sheet or several."""

import numpy as np
from numpy.typing import NDArray

from processing.shape.harmonics import evaluate

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
CASES = range(20)


def truth(seed: int) -> F64:
    coefficients = np.random.default_rng(1000 + seed).uniform(-0.2, 0.2, (9, 3))
    coefficients[0] = 2.5
    return coefficients


def surface(seed: int, count: int = 6000) -> tuple[F32, F32]:
    """Return normals and shading; every fourth case covers ±5°, ±20°, about a half and all of the sphere."""
    random = np.random.default_rng(seed)
    normals = random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    if spread := (0.08, 0.35, 1.0, 0.0)[seed % 4]:
        axis = random.normal(size=3)
        normals = spread * normals + axis / np.linalg.norm(axis)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    stored: F32 = normals.astype(np.float32)
    shading = evaluate(stored) @ truth(seed)
    if seed % 2:
        shading *= 1 - random.uniform(0, 0.8, (count, 1)) * (random.uniform(size=(count, 1)) < 0.3)
    if seed % 3 == 0:
        shading *= np.where(random.uniform(size=(count, 1)) < 0.4, 0.6, 1)
    if seed % 5 == 0:
        shading += random.normal(0, 0.01, shading.shape)
    return stored, shading.astype(np.float32)
