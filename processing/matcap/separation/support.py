"""How far a set of points reaches along each pixel's normal: its support function, by branch and bound.

A point that falls short of the best one at a tile's centre, by more than the tile's normals can make up for, is the
best for none of them. What is left after four levels of tiles is a handful for every pixel. Unlike a climb along a
hull's edges this cannot stop on a plateau, asks for no hull, and minds no points that coincide or lie in a plane.
"""

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.matcap.separation.pixel_tree import PixelTree

F64 = NDArray[np.float64]
Integers = NDArray[np.int64]

_ALIKE = 1e-15
"""Points nearer to each other than this times their length count as one."""


def support(points: F64, tree: PixelTree) -> F64:
    """Return the largest p · n over points p (M, 3), M ≥ 1, for each normal n of a tree (N,)."""
    largest = np.zeros(len(tree.normals))
    if len(largest):
        _search(np.ascontiguousarray(points.T), tree.normals, tree.starts, tree.centres, tree.radii, largest)
    return largest


@kernel
def _search(
    points: F64,
    normals: F64,
    starts: tuple[Integers, ...],
    centres: tuple[F64, ...],
    radii: tuple[F64, ...],
    largest: F64,
) -> None:
    count = points.shape[1]
    kept0, kept1 = np.zeros((3, count)), np.zeros((3, count))
    kept2, kept3 = np.zeros((3, count)), np.zeros((3, count))
    heights = np.zeros(count)
    t1 = t2 = t3 = 0
    for t0 in range(len(radii[0])):
        n0 = _narrow(points, count, centres[0][t0], radii[0][t0], kept0, heights)
        while t1 < len(radii[1]) and starts[1][t1] < starts[0][t0 + 1]:
            n1 = _narrow(kept0, n0, centres[1][t1], radii[1][t1], kept1, heights)
            while t2 < len(radii[2]) and starts[2][t2] < starts[1][t1 + 1]:
                n2 = _narrow(kept1, n1, centres[2][t2], radii[2][t2], kept2, heights)
                while t3 < len(radii[3]) and starts[3][t3] < starts[2][t2 + 1]:
                    n3 = _narrow(kept2, n2, centres[3][t3], radii[3][t3], kept3, heights)
                    for pixel in range(starts[3][t3], starts[3][t3 + 1]):
                        x, y, z = normals[pixel]
                        best = -np.inf
                        for i in range(n3):
                            best = max(best, kept3[0, i] * x + kept3[1, i] * y + kept3[2, i] * z)
                        largest[pixel] = best
                    t3 += 1
                t2 += 1
            t1 += 1


@kernel
def _narrow(points: F64, count: int, centre: F64, radius: float, kept: F64, heights: F64) -> int:
    """Keep the points that may be the best for a normal within the radius of the centre; return how many."""
    x, y, z = centre
    for i in range(count):
        heights[i] = points[0, i] * x + points[1, i] * y + points[2, i] * z
    top = 0
    for i in range(1, count):
        if heights[i] > heights[top]:
            top = i
    high, px, py, pz = heights[top], points[0, top], points[1, top], points[2, top]
    slack = 4e-16 * (abs(px) + abs(py) + abs(pz))
    alike = _ALIKE * (abs(px) + abs(py) + abs(pz))
    reach, least = radius * radius * (1 + 1e-9), alike * alike
    kept[0, 0], kept[1, 0], kept[2, 0] = px, py, pz
    n = 1
    for i in range(count):
        short = max(high - heights[i] - slack, 0.0)
        dx, dy, dz = px - points[0, i], py - points[1, i], pz - points[2, i]
        apart = dx * dx + dy * dy + dz * dz
        if short * short <= apart * reach and apart > least:
            kept[0, n], kept[1, n], kept[2, n] = points[0, i], points[1, i], points[2, i]
            n += 1
    return n
