"""A short tour over many poses: open, each pose once, deterministic.

No library at hand has one (SciPy solves assignments, not tours), and for some hundred poses the two classic local
moves come within a few per cent of the best.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Order = NDArray[np.intp]

MOST_ROUNDS, FEWEST_ROUNDS = 60, 2
MOST_PAIRS = 20_000_000
"""Pairs of poses that are looked at in all rounds; the more poses, the fewer rounds, so that nobody waits long."""
LONGEST_STRETCH = 3
"""Poses that or-opt moves together."""
WORTH_IT = 1e-9


def short_tour(joints: Sequence[tuple[float, float]]) -> list[int]:
    """Order poses whose ways are as long as their Euclidean distance, from the one that is lowest in the first joint.

    Parameters
    ----------
    joints : (N, 2) joint angles in degrees

    Returns
    -------
    order : indices of all poses, each once
    """
    points = np.asarray(joints, np.float64)
    distances = np.linalg.norm(points[:, None] - points[None], axis=-1)
    return shortest_tour(distances, int(np.argmin(points[:, 0])))


def shortest_tour(costs: F64, start: int) -> list[int]:
    """Order poses so that the sum of costs from the first to the last is small: nearest neighbour, 2-opt, or-opt.

    Parameters
    ----------
    costs : (N, N) of going from one pose to another, symmetric
    start : index of the first pose, which stays the first

    Returns
    -------
    order : indices of all poses, each once
    """
    order = _nearest_neighbour(costs, start)
    for _ in range(min(MOST_ROUNDS, max(FEWEST_ROUNDS, MOST_PAIRS // len(order) ** 2))):
        turned, moved = _two_opt(order, costs), _or_opt(order, costs)
        if not turned and not moved:
            break
    return [int(index) for index in order]


def tour_cost(costs: F64, order: Sequence[int]) -> float:
    """Return the sum of costs along a tour."""
    places = np.asarray(order, np.intp)
    return float(costs[places[:-1], places[1:]].sum())


def _nearest_neighbour(costs: F64, start: int) -> Order:
    order = np.zeros(len(costs), np.intp)
    order[0] = start
    left = np.ones(len(costs), bool)
    left[start] = False
    for place in range(1, len(costs)):
        order[place] = np.argmin(np.where(left, costs[order[place - 1]], np.inf))
        left[order[place]] = False
    return order


def _two_opt(order: Order, costs: F64) -> bool:
    """Turn round, in place, the stretch behind each pose that gains most by it; tell whether any did."""
    improved = False
    for i in range(len(order) - 2):
        here, after = order[i], order[i + 1]
        ends = order[i + 2 :]
        behind = costs[ends[:-1], ends[1:]]  # the last pose has no edge behind it
        gains = costs[here, after] - costs[here, ends]
        gains[:-1] += behind - costs[after, ends[1:]]
        best = int(np.argmax(gains))
        if gains[best] > WORTH_IT:
            order[i + 1 : i + best + 3] = order[i + 1 : i + best + 3][::-1].copy()
            improved = True
    return improved


def _or_opt(order: Order, costs: F64) -> bool:
    """Move, in place, short stretches to where they fit better, either way round; tell whether any was moved."""
    improved = False
    for length in range(1, LONGEST_STRETCH + 1):
        for i in range(1, len(order) - length + 1):
            stretch = order[i : i + length].copy()
            rest = np.concatenate([order[:i], order[i + length :]])
            first, last = stretch[0], stretch[-1]
            saved = costs[order[i - 1], first]
            if i + length < len(order):
                saved += costs[last, order[i + length]] - costs[order[i - 1], order[i + length]]
            onward = np.append(costs[rest[:-1], rest[1:]], 0.0)
            prices = []
            for head, tail in ((first, last), (last, first)):
                leaving = np.append(costs[tail, rest[1:]], 0.0)
                prices.append(costs[rest, head] + leaving - onward)
            best = int(np.argmin(np.minimum(*prices)))
            if saved - min(prices[0][best], prices[1][best]) > WORTH_IT:
                piece = stretch if prices[0][best] <= prices[1][best] else stretch[::-1]
                order[:] = np.concatenate([rest[: best + 1], piece, rest[best + 1 :]])
                improved = True
    return improved
