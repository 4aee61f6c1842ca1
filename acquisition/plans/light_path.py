"""Light directions in the order of shooting: spread over the hemisphere, on rings, from a list, or a dome's lamps."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from acquisition.plans.limits import MOST_LIGHTS, check_range
from acquisition.plans.step import Aim
from acquisition.tour import short_tour, shortest_tour
from litrig.base.directions import F64, angles_from_direction, direction_from_angles
from litrig.base.errors import InputError
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig
from rig.errors import OutOfRangeError

GOLDEN_ANGLE_DEG = 180 * (3 - math.sqrt(5))
DECIMALS = 3
LAMP_TOLERANCE_DEG = 1.0
"""How far a wanted direction may be from the lamp of a dome that stands in for it."""

Order = Literal["tour", "given"]


@dataclass(frozen=True)
class Sector:
    """The useful part of the hemisphere: a cone about the view axis, cut to a sector.

    Attributes
    ----------
    min_elevation_deg, max_elevation_deg : edges of the cone, both included
    azimuth_deg : from and to, counter-clockwise; a whole turn for all around
    """

    min_elevation_deg: float = 15.0
    max_elevation_deg: float = 80.0
    azimuth_deg: tuple[float, float] = (0.0, 360.0)

    def __post_init__(self) -> None:
        """Refuse an empty one."""
        low, high = self.min_elevation_deg, self.max_elevation_deg
        if not -90 <= low < high <= 90:
            raise InputError(f"min_elevation_deg, max_elevation_deg: {low:g}..{high:g}° must rise within -90..90°")
        start, end = self.azimuth_deg
        if not (abs(start) <= 360 and 0 < end - start <= 360 + 1e-9):
            raise InputError(f"azimuth_deg: {start:g}..{end:g}° must rise, by 360° at most, and start within ±360°")

    def holds(self, aim: Aim) -> bool:
        """Tell whether a light lies within."""
        start, end = self.azimuth_deg
        around = (aim.azimuth_deg - start) % 360 <= end - start
        return self.min_elevation_deg <= aim.elevation_deg <= self.max_elevation_deg and around

    def parameters(self) -> Mapping[str, Any]:
        """Return it as session.toml has it."""
        return {
            "min_elevation_deg": self.min_elevation_deg,
            "max_elevation_deg": self.max_elevation_deg,
            "azimuth_deg": list(self.azimuth_deg),
        }


EVERYWHERE = Sector(-90.0, 90.0)
USEFUL = Sector()
"""Lower lights graze, higher ones stand before the camera."""


@dataclass(frozen=True)
class LightPath:
    """Lights in the order in which they are lit.

    Attributes
    ----------
    aims : the lights
    made_from : how they were chosen, as session.toml has it
    """

    aims: tuple[Aim, ...]
    made_from: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        """Refuse none, and too many."""
        check_range("lights", len(self.aims), 1, MOST_LIGHTS, "40 to 80 are usual")


def evenly(lights: int, sector: Sector = USEFUL) -> list[Aim]:
    """Spread lights evenly: a Fibonacci spiral, equal steps of sin(elevation), turned by the golden angle each."""
    check_range("lights", lights, 1, MOST_LIGHTS, "40 to 80 are usual")
    low, high = (math.sin(math.radians(e)) for e in (sector.min_elevation_deg, sector.max_elevation_deg))
    start, end = sector.azimuth_deg
    turn = (end - start) / 360
    aims = []
    for i in range(lights):
        elevation_deg = math.degrees(math.asin(low + (high - low) * (i + 0.5) / lights))
        aims.append(_aim(start + i * GOLDEN_ANGLE_DEG % 360 * turn, elevation_deg))
    return aims


def on_rings(rings: Iterable[tuple[float, int]], azimuth_deg: tuple[float, float] = (0.0, 360.0)) -> list[Aim]:
    """Put lights on rings.

    All around, every second ring is turned by half a step, so that lights do not stand in columns; over a shorter range
    of azimuths each ring has a light at both its ends.

    Parameters
    ----------
    rings : elevation in degrees and number of lights of each
    azimuth_deg : from and to
    """
    start, end = azimuth_deg
    around = math.isclose(end - start, 360)
    aims = []
    for number, (elevation_deg, lights) in enumerate(rings):
        check_range("rings", elevation_deg, -90, 90, "an elevation in degrees")
        check_range("rings", lights, 1, MOST_LIGHTS, "a number of lights")
        steps = lights if around else max(lights - 1, 1)
        shift = number % 2 / 2 if around else 0.0
        aims += [_aim(start + (end - start) * (i + shift) / steps, elevation_deg) for i in range(lights)]
    return aims


def towards(directions: F64) -> list[Aim]:
    """Take lights from a list of directions (N, 3), view frame, of any length but zero."""
    return [_aim(*angles_from_direction(direction)) for direction in directions]


def lamps_of(directions_deg: Sequence[tuple[float, float]]) -> list[Aim]:
    """Take all lamps of a dome, from azimuth and elevation of each."""
    return [Aim(*angles, lamp) for lamp, angles in enumerate(directions_deg)]


def far_apart(aims: Sequence[Aim], lights: int) -> list[Aim]:
    """Choose lights that lie far apart: each next one is the farthest from all before, from the highest one on.

    Returns
    -------
    chosen : in the order in which they were given

    Raises
    ------
    InputError
        There are fewer.
    """
    check_range("lights", lights, 1, len(aims), f"there are {len(aims)} to choose from")
    directions = np.array([direction_from_angles(aim.azimuth_deg, aim.elevation_deg) for aim in aims])
    chosen = [int(np.argmax(directions[:, 2]))]
    nearness = directions @ directions[chosen[0]]
    while len(chosen) < lights:
        nearness[chosen] = np.inf
        chosen.append(int(np.argmin(nearness)))
        nearness = np.maximum(nearness, directions @ directions[chosen[-1]])
    return [aims[index] for index in sorted(chosen)]


def onto_lamps(aims: Iterable[Aim], directions_deg: Sequence[tuple[float, float]]) -> list[Aim]:
    """Replace each light by the lamp of a dome that hangs there.

    Raises
    ------
    InputError
        The dome has no lamp within a degree of one of them.
    """
    lamps = lamps_of(directions_deg)
    hang = np.array([direction_from_angles(*angles) for angles in directions_deg])
    found = []
    for aim in aims:
        near = np.linalg.norm(hang - direction_from_angles(aim.azimuth_deg, aim.elevation_deg), axis=1)
        lamp = lamps[int(np.argmin(near))]
        off_deg = math.degrees(2 * math.asin(min(1.0, float(near.min()) / 2)))
        if off_deg > LAMP_TOLERANCE_DEG:
            raise InputError(
                f"lights: azimuth {aim.azimuth_deg:g}°, elevation {aim.elevation_deg:g}°: the dome's nearest lamp, "
                f"{lamp.lamp}, hangs {off_deg:.1f}° off; ask for directions of its lamps, or for a number of lights"
            )
        found.append(lamp)
    return found


def in_tour(aims: Sequence[Aim], arm: ArmConfig | None = None) -> list[Aim]:
    """Order lights so that the way from the first to the last is short, beginning at the lowest azimuth.

    Parameters
    ----------
    arm : whose travel time counts; without it, and where it does not reach all lights, ways are as long as their angles
    """
    directions_deg = [(aim.azimuth_deg, aim.elevation_deg) for aim in aims]
    order = None
    if arm is not None:
        first = int(np.argmin([azimuth_deg for azimuth_deg, _ in directions_deg]))
        try:
            order = shortest_tour(travel_times_s(arm, directions_deg), first)
        except OutOfRangeError:
            order = None  # whoever checks the plan step by step says which light it is
    return [aims[index] for index in order or short_tour(directions_deg)]


def _aim(azimuth_deg: float, elevation_deg: float) -> Aim:
    return Aim(round(azimuth_deg % 360, DECIMALS) % 360, round(elevation_deg, DECIMALS))
