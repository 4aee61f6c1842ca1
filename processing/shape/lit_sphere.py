"""Environments on a ball: the Lit Sphere by which the Shape paper shows them."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from processing.paraboloid.read import lookup
from processing.shape import harmonics
from processing.shape.model import SurfaceEnvironment

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Part = Literal["diffuse", "reflection", "both"]


def lit_sphere(environment: SurfaceEnvironment, size: int, part: Part = "both") -> tuple[F32, NDArray[np.bool_]]:
    """Draw a ball seen from far away: D(n) and R(r), r the view axis mirrored at n.

    Light that is yet to be multiplied by an albedo is shown as it is, as on white.

    Returns
    -------
    picture : (size, size, 3) float32, linear light, 0 beside the ball
    on_ball : (size, size)
    """
    normals, on_ball = ball_normals(size)
    picture = np.zeros((size, size, 3), np.float32)
    n = normals[on_ball]
    if part != "reflection":
        picture[on_ball] += (harmonics.evaluate(n) @ environment.diffuse).astype(np.float32)
    if part != "diffuse":
        mirrored = 2 * n[:, 2:] * n - np.array([0.0, 0.0, 1.0])
        picture[on_ball] += lookup(environment.front, environment.back, mirrored)
    return picture, on_ball


def ball_normals(size: int) -> tuple[F64, NDArray[np.bool_]]:
    """Return the normals (size, size, 3) of a ball that fills the square, and where it is."""
    along = (2 * np.arange(size) + 1) / size - 1
    x, y = np.meshgrid(along, -along)
    flat = x * x + y * y
    return np.stack([x, y, np.sqrt(np.maximum(1 - flat, 0))], axis=-1), flat <= 1
