"""How long the arm travels, predicted without asking it: for the order of a plan and its duration."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import shortest_path

from litrig.base.directions import F64
from rig.arm.geometry import ArmGeometry, Joints
from rig.arm.zones import Reach
from rig.config import ArmConfig
from rig.errors import OutOfRangeError


@dataclass(frozen=True)
class Travel:
    """Straight moves in joint space under a trapezoid of speed, each from rest to rest."""

    speed_deg_s: float
    acceleration_deg_s2: float

    @classmethod
    def of(cls, config: ArmConfig) -> "Travel":
        """Take it from RIG.toml."""
        return cls(config.speed_deg_s, config.acceleration_deg_s2)

    def time_s(self, start: Joints, end: Joints) -> float:
        """Return the time of one move."""
        return float(self.times_s(np.array(math.dist(start, end))))

    def times_s(self, ways_deg: F64) -> F64:
        """Return the times of moves of given lengths, any shape."""
        speed, acceleration = self.speed_deg_s, self.acceleration_deg_s2
        short = ways_deg < speed * speed / acceleration
        return np.where(short, 2 * np.sqrt(ways_deg / acceleration), ways_deg / speed + speed / acceleration)


def travel_times_s(config: ArmConfig, directions_deg: Sequence[tuple[float, float]]) -> F64:
    """Return the travel times between directions of light, (N, N), symmetric.

    Between two directions the arm takes the turns of the azimuth that are nearest to each other, and a way around
    the zones.

    Parameters
    ----------
    directions_deg : azimuth and elevation in the view frame

    Raises
    ------
    OutOfRangeError
        The arm does not reach one of them, or there is no way between two.
    """
    geometry, reach, travel = ArmGeometry.of(config), Reach(config), Travel.of(config)
    choices = [reach.poses(geometry.joints(*direction)) for direction in directions_deg]
    for direction, poses in zip(directions_deg, choices, strict=True):
        if not poses:
            raise OutOfRangeError(
                f"light arm: azimuth {direction[0]:g}°, elevation {direction[1]:g}° is outside its reach; mend the plan"
            )
    most = max(len(poses) for poses in choices)
    padded = np.array([[*poses, *poses[-1:] * (most - len(poses))] for poses in choices])  # (N, turns, 2)
    bends = np.array(reach.bends()).reshape(-1, 2)
    between_s = shortest_path(_straight_s(bends, bends, reach, travel)) if len(bends) else np.zeros((0, 0))
    times_s = np.full((len(choices), len(choices)), np.inf)
    for i, j in itertools.product(range(most), repeat=2):
        starts, ends = padded[:, i], padded[:, j]
        times_s = np.minimum(times_s, _straight_s(starts, ends, reach, travel))
        if len(bends):
            to_last_bend_s = _chained(_straight_s(starts, bends, reach, travel), between_s)
            times_s = np.minimum(times_s, _chained(to_last_bend_s, _straight_s(bends, ends, reach, travel)))
    if not np.isfinite(times_s).all():
        raise OutOfRangeError("light arm: between two directions of the plan no way leads around the zones; mend it")
    return times_s


def _straight_s(starts: F64, ends: F64, reach: Reach, travel: Travel) -> F64:
    """Return the times of straight ways from (N, 2) to (M, 2), as (N, M); infinite where a zone is in the way."""
    a, b = starts[:, None], ends[None]
    return np.where(reach.are_free(a, b), travel.times_s(np.linalg.norm(a - b, axis=-1)), np.inf)


def _chained(first: F64, second: F64) -> F64:
    """Return the shortest times (N, K) of ways of two legs, (N, M) and (M, K)."""
    best = np.full((first.shape[0], second.shape[1]), np.inf)
    for middle in range(first.shape[1]):
        best = np.minimum(best, first[:, middle, None] + second[None, middle])
    return best


def way_time_s(start: Joints, way: Sequence[Joints], travel: Travel) -> float:
    """Return the time of a way of straight pieces."""
    return sum(travel.time_s(a, b) for a, b in itertools.pairwise([start, *way]))
