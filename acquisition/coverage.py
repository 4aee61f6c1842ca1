"""How well a plan covers what it samples: the hemisphere with lights, the turn with slices."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from acquisition.plans import Aim, Plan
from litrig.base.directions import F64, direction_from_angles

PROBES = 40_000
"""Directions over the sphere among which the emptiest is sought; they lie about a degree apart."""


@dataclass(frozen=True)
class LightCoverage:
    """How lights lie; angles in degrees.

    Attributes
    ----------
    lights : how many different directions
    min_elevation_deg, max_elevation_deg : the lowest and the highest
    nearest_deg, spacing_deg : from a light to its nearest neighbour: the least, and the median
    gap_deg : radius of the largest cap without a light in it, its middle no lower than the lowest light
    gap_azimuth_deg, gap_elevation_deg : its middle
    """

    lights: int
    min_elevation_deg: float
    max_elevation_deg: float
    nearest_deg: float
    spacing_deg: float
    gap_deg: float
    gap_azimuth_deg: float
    gap_elevation_deg: float


@dataclass(frozen=True)
class TurnCoverage:
    """How slices lie; angles in degrees.

    Attributes
    ----------
    slices : how many different angles
    first_deg, last_deg : the least and the greatest
    step_deg : the least from one to the next
    gap_deg : the greatest, around the turn
    """

    slices: int
    first_deg: float
    last_deg: float
    step_deg: float
    gap_deg: float


@dataclass(frozen=True)
class Coverage:
    """What a plan covers; None where it leaves lights or turntable alone."""

    lights: LightCoverage | None
    turn: TurnCoverage | None

    def as_json(self) -> Mapping[str, Any]:
        """Return it for programs."""
        parts = {"lights": self.lights, "turn": self.turn}
        return {
            name: {key: round(value, 3) for key, value in asdict(part).items()}
            for name, part in parts.items()
            if part is not None
        }


def coverage(plan: Plan) -> Coverage:
    """Look at the poses of a plan."""
    aims, turn = plan.poses.aims, plan.poses.turn
    return Coverage(light_coverage(aims) if aims else None, None if turn is None else turn_coverage(turn))


def light_coverage(aims: Iterable[Aim]) -> LightCoverage:
    """Measure how evenly lights cover the hemisphere above the lowest of them.

    The largest empty cap is found among directions about a degree apart, so that its radius is low by half a degree at
    most.
    """
    angles = np.array(sorted({(aim.azimuth_deg, aim.elevation_deg) for aim in aims}))
    directions = np.array([direction_from_angles(*pair) for pair in angles])
    tree = cKDTree(directions)
    apart_deg = np.array([0.0])
    if len(directions) > 1:
        apart_deg = _angles_deg(tree.query(directions, k=2)[0][:, 1])
    lowest_deg = float(angles[:, 1].min())
    probes = _probes(lowest_deg)
    distances, _ = tree.query(probes)
    emptiest = int(np.argmax(distances))
    x, y, z = probes[emptiest]
    return LightCoverage(
        len(directions),
        lowest_deg,
        float(angles[:, 1].max()),
        float(apart_deg.min()),
        float(np.median(apart_deg)),
        float(_angles_deg(distances[emptiest])),
        math.degrees(math.atan2(y, x)) % 360,
        math.degrees(math.asin(z)),
    )


def turn_coverage(angles_deg: Iterable[float]) -> TurnCoverage:
    """Measure how evenly slices cover a turn."""
    angles = np.unique(np.fromiter(angles_deg, float))
    around = np.unique(np.round(angles % 360, 6) % 360)
    gaps = np.diff(np.append(around, around[0] + 360))
    return TurnCoverage(len(angles), float(angles[0]), float(angles[-1]), float(gaps.min()), float(gaps.max()))


def _probes(lowest_deg: float) -> F64:
    """Return directions (N, 3) spread evenly over the sphere from an elevation up, its edge and its top."""
    index = np.arange(PROBES) + 0.5
    low = math.sin(math.radians(lowest_deg))
    z = 1 - (1 - low) * index / PROBES
    azimuth_rad = index * math.pi * (3 - math.sqrt(5))
    flat = np.sqrt(np.maximum(0, 1 - z * z))
    edge_rad = np.linspace(0, 2 * math.pi, 720, endpoint=False)
    edge = np.stack([math.sqrt(1 - low * low) * np.cos(edge_rad), math.sqrt(1 - low * low) * np.sin(edge_rad)], axis=-1)
    spread = np.stack([flat * np.cos(azimuth_rad), flat * np.sin(azimuth_rad), z], axis=-1)
    return np.concatenate([spread, np.column_stack([edge, np.full(len(edge), low)]), [[0.0, 0.0, 1.0]]])


def _angles_deg(chords: F64) -> F64:
    return np.asarray(np.degrees(2 * np.arcsin(np.minimum(1.0, np.asarray(chords) / 2))))
