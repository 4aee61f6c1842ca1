"""The Gaussian whose share in a window has a given mean and variance: the MatCap paper's equation 6, without its flaws.

Equation 6 takes the product of two Gaussians for a Gaussian, and the variance of the window for (ε/3)². Both hold only
for windows without ends; and as printed its sign is wrong. Here the window ends where it ends, also at a rim on one
side, and the feature may lie off its centre.
"""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)
_ROUNDS, _CLOSE = 25, 1e-9
_LONGEST_STEP = 0.5
_WINDOW = 4.5


def gaussian_behind(mean: F64, variance: F64, begin: F64, end: F64) -> tuple[F64, F64]:
    """Find the Gaussian that, weighted by a window, has this mean and variance.

    Densities proportional to W(u)·exp(a u + b u²) on [begin, end], with W(u) = exp(−9u²/2), form an exponential family:
    one pair (a, b) has the given moments. Newton's method finds it. Without the window the variance is −1/(2b), the
    mean −a/(2b).

    Parameters
    ----------
    mean, variance, begin, end : (...) in units of ε, the window's half width; −1 ≤ begin < end ≤ 1

    Returns
    -------
    mean, variance : (...) in units of ε and ε²; NaN where no Gaussian has these moments, flat as they are
    """
    shape = np.broadcast_shapes(mean.shape, variance.shape, begin.shape, end.shape)
    mean, variance, begin, end = (np.broadcast_to(part, shape).ravel() for part in (mean, variance, begin, end))
    found = np.full((2, *mean.shape), np.nan)
    # Nothing in a window varies more than a value at either end.
    possible = np.isfinite(mean + variance) & (variance > 1e-6) & (mean > begin) & (mean < end)
    possible &= variance < (end - mean) * (mean - begin)
    todo = np.flatnonzero(possible)
    # Of W·exp(a u + b u²) as a whole: b with the window's own bend.
    linear, square = mean[todo] / variance[todo], -0.5 / variance[todo]
    for _ in range(_ROUNDS):
        step, error = _newton(linear, square, mean[todo], variance[todo], begin[todo], end[todo])
        linear, square = linear + step[0], square + step[1]
        done = error < _CLOSE
        beyond = ~np.isfinite(linear + square) | (square > 50)
        bend = square + _WINDOW
        peaked = done & (bend < 0)
        found[:, todo[peaked]] = -0.5 * linear[peaked] / bend[peaked], -0.5 / bend[peaked]
        keep = ~done & ~beyond
        todo, linear, square = todo[keep], linear[keep], square[keep]
        if not todo.size:
            break
    return found[0].reshape(shape), found[1].reshape(shape)


def _newton(linear: F64, square: F64, mean: F64, variance: F64, begin: F64, end: F64) -> tuple[tuple[F64, F64], F64]:
    """Return a step of (a, b) towards the moments, and how far off the moments are, relative to the variance."""
    half = (end - begin)[:, None] / 2
    u = (begin + end)[:, None] / 2 + half * _NODES
    u2 = u * u
    exponent = linear[:, None] * u + square[:, None] * u2
    density = np.exp(exponent - exponent.max(axis=1, keepdims=True)) * _WEIGHTS
    density /= density.sum(axis=1, keepdims=True)
    # Products, for general powers take most of the time.
    weighed = density * u2
    first, second = (density * u).sum(axis=1), weighed.sum(axis=1)
    third, fourth = (weighed * u).sum(axis=1), (weighed * u2).sum(axis=1)
    off_linear, off_square = mean - first, variance + mean**2 - second
    var_u, cov, var_u2 = second - first**2, third - first * second, fourth - second**2
    determinant = np.maximum(var_u * var_u2 - cov**2, 1e-300)
    steps = (
        (var_u2 * off_linear - cov * off_square) / determinant,
        (var_u * off_square - cov * off_linear) / determinant,
    )
    # Far from the goal a full step can overshoot; the family is convex, so that shorter ones arrive.
    scale = 1 + np.abs(square)
    length = np.maximum(np.abs(steps[0]), np.abs(steps[1])) / scale
    shorten = np.minimum(1, _LONGEST_STEP / np.maximum(length, 1e-300))
    error = np.maximum(np.abs(off_linear) / np.sqrt(variance), np.abs(off_square) / variance)
    return (steps[0] * shorten, steps[1] * shorten), error
