"""Gradient noise in space, with its derivative (K. Perlin, Improving Noise, 2002)."""

import math

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.shape.bands import in_bands

F32 = NDArray[np.float32]
_PERIOD = 256


def layered_noise(points: F32, octaves: int, seed: int) -> F32:
    """Add up octaves of noise, each with features half as large and half as high as the one before.

    Parameters
    ----------
    points : (N, 3) float32; features of the first octave are of length 1

    Returns
    -------
    values : (N, 4) float32, noise of amplitude about 1, and its gradient
    """
    random = np.random.default_rng(seed)
    gradients = random.normal(size=(_PERIOD, 3))
    gradients /= np.linalg.norm(gradients, axis=1, keepdims=True)
    values = np.zeros((len(points), 4), np.float32)
    order = random.permutation(_PERIOD).astype(np.int64)
    in_bands(len(points), lambda first, end: _add_noise(first, end, points, order, gradients, octaves, values))
    return values


@kernel
def _add_noise(
    first: int,
    end: int,
    points: F32,
    order: NDArray[np.int64],
    gradients: NDArray[np.float64],
    octaves: int,
    values: F32,
) -> None:
    for index in range(first, end):
        amplitude, frequency = 1.0, 1.0
        for octave in range(octaves):
            # An offset for each octave, or all would be 0 at the origin.
            x = points[index, 0] * frequency + 17.31 * octave
            y = points[index, 1] * frequency + 5.73 * octave
            z = points[index, 2] * frequency + 41.17 * octave
            i, j, k = math.floor(x), math.floor(y), math.floor(z)
            fx, fy, fz = x - i, y - j, z - k
            wx, wy, wz = fx**3 * (fx * (fx * 6 - 15) + 10), fy**3 * (fy * (fy * 6 - 15) + 10), 0.0
            wz = fz**3 * (fz * (fz * 6 - 15) + 10)
            dwx, dwy = 30 * (fx * (fx - 1)) ** 2, 30 * (fy * (fy - 1)) ** 2
            dwz = 30 * (fz * (fz - 1)) ** 2
            total, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
            for a in range(2):
                for b in range(2):
                    for c in range(2):
                        place = order[(int(i) + a) & 255]
                        place = order[(place + int(j) + b) & 255]
                        place = order[(place + int(k) + c) & 255]
                        g0, g1, g2 = gradients[place, 0], gradients[place, 1], gradients[place, 2]
                        ramp = g0 * (fx - a) + g1 * (fy - b) + g2 * (fz - c)
                        sx, tx = (wx, dwx) if a else (1 - wx, -dwx)
                        sy, ty = (wy, dwy) if b else (1 - wy, -dwy)
                        sz, tz = (wz, dwz) if c else (1 - wz, -dwz)
                        share = sx * sy * sz
                        total += share * ramp
                        gx += share * g0 + tx * sy * sz * ramp
                        gy += share * g1 + sx * ty * sz * ramp
                        gz += share * g2 + sx * sy * tz * ramp
            values[index, 0] += amplitude * total
            values[index, 1] += amplitude * frequency * gx
            values[index, 2] += amplitude * frequency * gy
            values[index, 3] += amplitude * frequency * gz
            amplitude *= 0.5
            frequency *= 2.0
