"""A short way over many poses, for devices whose joints move at one speed and do not wrap around."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

MOST_ROUNDS = 30


def short_tour(joints: Sequence[tuple[float, float]]) -> list[int]:
    """Order poses so that the way from the first to the last is short: nearest neighbour, then 2-opt.

    Parameters
    ----------
    joints : (N, 2) joint angles in degrees; a way is as long as their Euclidean distance

    Returns
    -------
    order : indices of all poses, each once; the tour starts at the pose that is lowest in the first joint
    """
    points = np.asarray(joints, np.float64)
    distances = np.linalg.norm(points[:, None] - points[None], axis=-1)
    return _two_opt(_nearest_neighbour(distances, int(np.argmin(points[:, 0]))), distances)


def _nearest_neighbour(distances: NDArray[np.float64], start: int) -> list[int]:
    order, left = [start], set(range(len(distances))) - {start}
    while left:
        nearest = min(left, key=lambda index: (distances[order[-1], index], index))
        order.append(nearest)
        left.remove(nearest)
    return order


def _two_opt(order: list[int], distances: NDArray[np.float64]) -> list[int]:
    for _ in range(MOST_ROUNDS):
        improved = False
        for i in range(len(order) - 2):
            for j in range(i + 2, len(order)):
                # Turning the stretch i+1..j round replaces two edges; the last pose has no edge behind it.
                after = distances[order[i + 1], order[j + 1]] if j + 1 < len(order) else 0.0
                before = distances[order[j], order[j + 1]] if j + 1 < len(order) else 0.0
                gain = distances[order[i], order[i + 1]] + before - distances[order[i], order[j]] - after
                if gain > 1e-9:
                    order[i + 1 : j + 1] = reversed(order[i + 1 : j + 1])
                    improved = True
        if not improved:
            break
    return order
