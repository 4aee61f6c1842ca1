"""Solving Laplace's and Poisson's equation on a dual paraboloid map at once, by factors of a sparse matrix.

Slower than multigrid and in need of memory, but there is no hole that it does not fill.
"""

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from processing.paraboloid.multigrid import Level
from processing.paraboloid.seam import F64

MOST_DIRECTLY = 500_000
"""Unknown texels; the factors of so many take some gigabytes."""


def solve_directly(level: Level, values: Sequence[F64], sources: Sequence[F64]) -> list[F64]:
    """Solve channels of one grid, ghosts among the unknowns.

    Parameters
    ----------
    level : the finest of `multigrid.levels`
    values : (2, side, side) each, known texels hold what is known
    sources : (2, side, side) each
    """
    count, side = level.free.size, level.shape[-1]
    free = np.flatnonzero(level.free)
    solved = np.concatenate([free, level.ghosts.targets])
    rows = np.concatenate([np.repeat(free, 4), np.repeat(level.ghosts.targets, 4)])
    columns = np.concatenate([(free[:, None] + np.array([-1, 1, -side, side])).ravel(), level.ghosts.sources.ravel()])
    weights = np.concatenate([np.full(4 * free.size, 0.25), level.ghosts.weights.ravel()])
    reads = sparse.csr_array((weights, (rows, columns)), (count, count))[solved]
    inner = sparse.csc_array(sparse.eye_array(solved.size) - reads[:, solved])
    fixed = np.stack([plane.ravel() for plane in values], axis=-1)
    fixed[solved] = 0
    told = reads @ fixed
    told[: free.size] -= 0.25 * np.stack([plane.ravel()[free] for plane in sources], axis=-1)
    fixed[solved] = splu(inner).solve(told)
    return [np.ascontiguousarray(plane).reshape(level.shape) for plane in fixed.T]
