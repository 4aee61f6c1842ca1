"""Ever more blurred copies of dual paraboloid maps, so that any roughness is a read between two of them.

They are blurred on the sphere, not averaged in boxes as mip levels are. Level 0 is the maps themselves, level 1 is
blurred by one texel, and every other one by twice the variance of the one before.
"""

import numpy as np
from numpy.typing import NDArray

from processing.paraboloid.blur import blurred_small, largest_texel, resized

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

LARGEST_SIDE = 256
"""Blurred copies need no more texels than this, since they are blurred by at least one of these."""


def chain_side(size: int) -> int:
    """Return the side of the blurred copies of maps of `size`."""
    return min(size, LARGEST_SIDE)


def blur_chain(front: F32, back: F32, most: float) -> F32:
    """Return the blurred copies of maps (S, S, 3), as far as a variance of `most` needs them.

    Returns
    -------
    levels : (N, 2, s, s, 3) float32, levels 1 to N, front and back; at least one
    """
    side = chain_side(front.shape[0])
    small = resized(front, back, side)
    levels: list[F32] = []
    reached = 0.0
    while not levels or reached < most:
        variance = variance_of(len(levels) + 1, side)
        small = blurred_small(*small, variance - reached)
        reached = variance
        levels.append(np.stack(resized(*small, side)))
    return np.stack(levels)


def variance_of(level: int, side: int) -> float:
    """Return the variance, radians squared, that a level from 1 on is blurred by."""
    return float(largest_texel(side) ** 2 * 2.0 ** (level - 1))


def level_of(variance: F64, side: int) -> F64:
    """Return levels, between whole ones, for variances: straight up to level 1, then by the logarithm."""
    steps = variance / largest_texel(side) ** 2
    return np.where(steps < 1, steps, 1 + np.log2(np.maximum(steps, 1)))
