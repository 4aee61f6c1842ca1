"""Shading under other normals, in plain NumPy and double precision: what shaders and kernels are tested against."""

import numpy as np
from numpy.typing import NDArray

from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.albedo import check_reflectance
from processing.shape.horizon import HORIZON
from processing.shape.model import Environments, ShadingBuffers

F64 = NDArray[np.float64]
Factor = float | NDArray[np.floating]
MISALIGNED_RAD = 0.005 * np.pi
"""ε: from here on the reflection is that of the environment alone."""


def recompose(
    buffers: ShadingBuffers,
    environments: Environments,
    normals: NDArray[np.floating],
    *,
    diffuse_factor: Factor = 1.0,
    reflection_factor: Factor = 1.0,
    horizon: float = HORIZON,
) -> F64:
    """Shade a picture again under changed normals (the Shape paper, equations 3 to 5, in linear light).

    Equation 5 is taken as a change of the picture, I + α·((k_D·D̃ − D₀) + (k_R·R̃ − R₀)), and the others as changes of
    D₀ and R₀, so that what is untouched keeps its value bit by bit whatever I has besides: emission, transparency; its
    gamma is the display's affair. Angles are taken from chords, which are 0 where nothing was changed. What was
    negative before, by a filter's overshooting, may stay so; nothing else becomes it. Equation 4's α_R says what hides
    mirrored rays as they were; rays that an edit turns to below the surface are hidden by it as well.

    Parameters
    ----------
    normals : (H, W, 3) unit, ñ; surfaces without an environment stay as they are
    diffuse_factor, reflection_factor : k_D and k_R, for all pixels or (H, W)
    horizon : r̃·n from which down the surface hides mirrored rays; 0 is equation 4 as it is printed

    Returns
    -------
    picture : (H, W, 3) float64, linear light

    Raises
    ------
    InputError
        An environment holds light before an albedo that the buffers lack.
    """
    check_reflectance(buffers, environments)
    picture = buffers.picture.astype(np.float64)
    eyes = buffers.to_eye
    for number, environment in environments.items():
        here = buffers.surfaces == number
        n, changed = buffers.normals[here].astype(np.float64), normals[here].astype(np.float64)
        d0, r0 = buffers.diffuse[here].astype(np.float64), buffers.reflection[here].astype(np.float64)
        alpha = buffers.coverage[here].astype(np.float64)[:, None]
        alpha_d, alpha_r = (
            occlusion[here].astype(np.float64)[:, None]
            for occlusion in (buffers.ambient_occlusion, buffers.reflection_occlusion)
        )
        k_d, k_r = (np.broadcast_to(k, here.shape)[here][:, None] for k in (diffuse_factor, reflection_factor))
        rebuilt = (harmonics.evaluate(changed) - harmonics.evaluate(n)) @ environment.diffuse.astype(np.float64)
        if environment.diffuse_is_illumination and buffers.albedo is not None:
            rebuilt = rebuilt * buffers.albedo[here]
        diffuse = d0 + alpha_d * (np.maximum(d0 + rebuilt, np.minimum(d0, 0)) - d0)
        to_eye = eyes[here].astype(np.float64)
        r, r_changed = (2 * np.sum(m * to_eye, axis=1, keepdims=True) * m - to_eye for m in (n, changed))
        angle = 2 * np.arcsin(np.minimum(1, np.linalg.norm(r - r_changed, axis=1, keepdims=True) / 2))
        share = np.minimum(1, angle / MISALIGNED_RAD) * alpha_r
        if horizon > 0:
            share = share * np.clip(np.sum(r_changed * n, axis=1, keepdims=True) / horizon, 0, 1)
        mirrored = lookup(environment.front, environment.back, r_changed)
        if environment.reflection_is_illumination and buffers.reflection_albedo is not None:
            mirrored = mirrored * buffers.reflection_albedo[here]
        reflection = r0 + share * (mirrored - r0)
        change = alpha * ((k_d * diffuse - d0) + (k_r * reflection - r0))
        # The sum alone would turn −0 into 0, and the infinite into no number.
        picture[here] = np.where(change == 0, picture[here], picture[here] + change)
    return picture
