"""Where the arm must not go, or not stop: limits on pairs of joint angles, and ways around them."""

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import dijkstra

from litrig.base.directions import F64
from rig.arm.geometry import Joints
from rig.config import ArmConfig, ZoneConfig

CLEARANCE_DEG = 0.5
"""How far a way around a zone keeps from it; it bends at that distance from the corners."""
EDGE_DEG = 1e-6


@dataclass(frozen=True)
class Box:
    """A rectangle of joint angles."""

    low: Joints
    high: Joints

    def holds(self, joints: Joints) -> bool:
        """Tell whether a pose lies within; the edge does not count."""
        return all(a + EDGE_DEG < x < b - EDGE_DEG for a, x, b in zip(self.low, joints, self.high, strict=True))

    def is_crossed(self, start: Joints, end: Joints) -> bool:
        """Tell whether the straight way between two poses runs through it."""
        return bool(self.crossings(np.array(start), np.array(end)))

    def crossings(self, starts: F64, ends: F64) -> NDArray[np.bool_]:
        """Tell the same of many ways at once, (…, 2) and (…, 2), by Liang and Barsky's clipping."""
        starts, ends = np.broadcast_arrays(starts, ends)
        low, high = np.array(self.low) + EDGE_DEG, np.array(self.high) - EDGE_DEG
        way = ends - starts
        level = np.abs(way) < 1e-12
        safe = np.where(level, 1.0, way)
        first, last = (low - starts) / safe, (high - starts) / safe
        within = (low < starts) & (starts < high)
        enters = np.where(level, np.where(within, 0.0, np.inf), np.minimum(first, last))
        leaves = np.where(level, np.where(within, 1.0, -np.inf), np.maximum(first, last))
        return np.asarray(np.maximum(enters.max(-1), 0.0) < np.minimum(leaves.min(-1), 1.0))

    def corners(self) -> list[Joints]:
        """Return the places where ways around it bend."""
        around = (self.low.azimuth_deg - CLEARANCE_DEG, self.high.azimuth_deg + CLEARANCE_DEG)
        up = (self.low.elevation_deg - CLEARANCE_DEG, self.high.elevation_deg + CLEARANCE_DEG)
        return [Joints(*pair) for pair in itertools.product(around, up)]

    def way_out(self, joints: Joints) -> list[Joints]:
        """Return the places just outside its four sides, nearest first."""
        (left, low), (right, high) = self.low, self.high
        outside = [
            Joints(left - CLEARANCE_DEG, joints.elevation_deg),
            Joints(right + CLEARANCE_DEG, joints.elevation_deg),
            Joints(joints.azimuth_deg, low - CLEARANCE_DEG),
            Joints(joints.azimuth_deg, high + CLEARANCE_DEG),
        ]
        return sorted(outside, key=lambda place: math.dist(place, joints))


class Reach:
    """What the arm may do: the limits of each joint, the zones to keep out of, the zones to pass through only."""

    def __init__(self, config: ArmConfig) -> None:
        self._limits = Box(
            Joints(config.min_azimuth_deg, config.min_elevation_deg),
            Joints(config.max_azimuth_deg, config.max_elevation_deg),
        )
        self._keep_out = list(self._boxes(zone for zone in config.zones if not zone.may_pass))
        self._dead = list(self._boxes(zone for zone in config.zones if zone.may_pass))

    def poses(self, joints: Joints) -> list[Joints]:
        """Return all the turns of a pose that the arm may take, each a different place of the cables."""
        low, high = self._limits.low.azimuth_deg, self._limits.high.azimuth_deg
        turns = range(math.ceil((low - joints.azimuth_deg) / 360), math.floor((high - joints.azimuth_deg) / 360) + 1)
        poses = [Joints(joints.azimuth_deg + 360 * turn, joints.elevation_deg) for turn in turns]
        return [pose for pose in poses if self._has(pose) and not self.zone_at(pose)]

    def zone_at(self, pose: Joints) -> str:
        """Return the name of a zone that forbids to stop at a pose, or nothing."""
        return next((name for name, box in self._keep_out + self._dead if box.holds(pose)), "")

    def route(self, start: Joints, goal: Joints, cost: Callable[[Joints, Joints], float]) -> list[Joints] | None:
        """Return the cheapest way of straight pieces that touches no zone, without its start; None if there is none.

        An arm that homing left in a zone comes out of it by the nearest side first.
        """
        boxes = [box for _, box in self._keep_out]
        for box in boxes:
            if box.holds(start):
                return self._out_and_on(box, start, goal, cost)
        if self._is_free(start, goal):
            return [goal]
        places = [start, goal, *self.bends()]
        costs = np.zeros((len(places), len(places)))
        for i, j in itertools.combinations(range(len(places)), 2):
            if self._is_free(places[i], places[j]):
                costs[i, j] = costs[j, i] = max(cost(places[i], places[j]), 1e-9)
        lengths, before = dijkstra(costs, indices=0, return_predecessors=True)
        if not math.isfinite(lengths[1]):
            return None
        way, place = [goal], int(before[1])
        while place != 0:
            way.append(places[place])
            place = int(before[place])
        return way[::-1]

    def bends(self) -> list[Joints]:
        """Return the places where ways around the zones may bend."""
        boxes = [box for _, box in self._keep_out]
        corners = [corner for box in boxes for corner in box.corners() if self._has(corner)]
        return [corner for corner in corners if not any(box.holds(corner) for box in boxes)]

    def are_free(self, starts: F64, ends: F64) -> NDArray[np.bool_]:
        """Tell of straight ways, (…, 2) and (…, 2), whether they touch no zone."""
        crossed = [box.crossings(starts, ends) for _, box in self._keep_out]
        shape = np.broadcast_shapes(starts.shape, ends.shape)[:-1]
        return ~np.any(crossed, axis=0) if crossed else np.full(shape, fill_value=True)

    def _out_and_on(
        self, box: Box, start: Joints, goal: Joints, cost: Callable[[Joints, Joints], float]
    ) -> list[Joints] | None:
        others = [other for _, other in self._keep_out if other is not box]
        for outside in box.way_out(start):
            if not self._has(outside) or any(other.is_crossed(start, outside) for other in others):
                continue
            onward = self.route(outside, goal, cost)
            if onward is not None:
                return [outside, *onward]
        return None

    def _is_free(self, start: Joints, end: Joints) -> bool:
        return bool(self.are_free(np.array(start), np.array(end)))

    def _has(self, joints: Joints) -> bool:
        pairs = zip(self._limits.low, joints, self._limits.high, strict=True)
        return all(low - EDGE_DEG <= x <= high + EDGE_DEG for low, x, high in pairs)

    def _boxes(self, zones: Iterable[ZoneConfig]) -> Iterable[tuple[str, Box]]:
        """Repeat each zone for every turn of the azimuth that the arm can make."""
        for zone in zones:
            (left, right), (low, high) = zone.azimuth_deg, zone.elevation_deg
            first = math.floor((self._limits.low.azimuth_deg - right) / 360)
            last = math.ceil((self._limits.high.azimuth_deg - left) / 360)
            for turn in range(first, last + 1):
                yield zone.name, Box(Joints(left + 360 * turn, low), Joints(right + 360 * turn, high))
