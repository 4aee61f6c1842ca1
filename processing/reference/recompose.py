"""Shading under other normals, in plain NumPy and double precision: what shaders are tested against."""

import numpy as np
from numpy.typing import NDArray

from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.model import Environments, ShadingBuffers

F64 = NDArray[np.float64]
MISALIGNED_RAD = 0.005 * np.pi
"""ε: from here on the reflection is that of the environment alone."""


def recompose(
    buffers: ShadingBuffers,
    environments: Environments,
    normals: NDArray[np.floating],
    *,
    diffuse_factor: float = 1.0,
    reflection_factor: float = 1.0,
) -> F64:
    """Shade a picture again under changed normals (the Shape paper, equations 3 to 5, in linear light).

    Equation 5 is taken as a change of the picture, I + α·((k_D·D̃ + k_R·R̃) − (D₀ + R₀)), so that what is untouched
    keeps its value whatever I has besides; its gamma is the display's affair.

    Parameters
    ----------
    normals : (H, W, 3) unit, ñ; surfaces without an environment stay as they are
    diffuse_factor, reflection_factor : k_D and k_R

    Returns
    -------
    picture : (H, W, 3) float64, linear light
    """
    picture = buffers.picture.astype(np.float64)
    for number, environment in environments.items():
        here = buffers.surfaces == number
        n, changed = buffers.normals[here].astype(np.float64), normals[here].astype(np.float64)
        d0, r0 = buffers.diffuse[here].astype(np.float64), buffers.reflection[here].astype(np.float64)
        alpha = buffers.coverage[here].astype(np.float64)[:, None]
        alpha_d, alpha_r = (
            occlusion[here].astype(np.float64)[:, None]
            for occlusion in (buffers.ambient_occlusion, buffers.reflection_occlusion)
        )
        rebuilt = (harmonics.evaluate(changed) - harmonics.evaluate(n)) @ environment.diffuse.astype(np.float64)
        diffuse = alpha_d * np.maximum(d0 + rebuilt, 0) + (1 - alpha_d) * d0
        to_eye = -buffers.positions[here].astype(np.float64)
        to_eye /= np.linalg.norm(to_eye, axis=1, keepdims=True)
        r, r_changed = (2 * np.sum(m * to_eye, axis=1, keepdims=True) * m - to_eye for m in (n, changed))
        angle = np.arccos(np.clip(np.sum(r * r_changed, axis=1, keepdims=True), -1, 1))
        share = np.minimum(1, np.where(np.all(n == changed, axis=1, keepdims=True), 0, angle) / MISALIGNED_RAD)
        share = share * alpha_r
        reflection = share * lookup(environment.front, environment.back, r_changed) + (1 - share) * r0
        picture[here] += alpha * (diffuse_factor * diffuse + reflection_factor * reflection - (d0 + r0))
    return picture
