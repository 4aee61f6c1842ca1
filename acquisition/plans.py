"""What to shoot: plans are frozen data, know their length, and never how to get there."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from typing import Any, Literal, Protocol

import numpy as np

from acquisition.tour import short_tour, shortest_tour, tour_cost
from litrig.base.capture_folder.capture import Role
from litrig.base.errors import InputError
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig

GOLDEN_ANGLE_DEG = 180 * (3 - math.sqrt(5))
FEWEST_SLICES = 8
FEWEST_LIGHTS = 6
"""A PTM has six coefficients."""
MOST_STEPS = 100_000


@dataclass(frozen=True)
class Aim:
    """A light direction in the view frame, in degrees, and the lamp that shines from it."""

    azimuth_deg: float
    elevation_deg: float
    lamp: int = 0


@dataclass(frozen=True)
class Step:
    """One wanted frame.

    Attributes
    ----------
    step : its number in the plan, by which the frame is known for ever
    role : what the frame is for
    angle_deg : where the turntable stands; None leaves it alone
    aim : where the light comes from; None leaves the lights alone
    exposure_ev : stops above the rig's own exposure time, for brackets
    repeat : which of the frames that are alike, for averages
    lit : whether the lamps shine; a dark frame is shot without
    ask : what a person must have done before, such as to put the white card there; empty for nothing
    """

    step: int
    role: Role = Role.FRAME
    angle_deg: float | None = None
    aim: Aim | None = None
    exposure_ev: float = 0.0
    repeat: int = 0
    lit: bool = True
    ask: str = ""

    @property
    def stem(self) -> str:
        """A file name without ending that tells the pose to a human reader."""
        parts = [f"{self.step:06d}"]
        if self.role is not Role.FRAME:
            parts.append(self.role)
        if self.angle_deg is not None:
            parts.append(f"tt{self.angle_deg:06.2f}")
        if self.aim is not None:
            parts.append(f"az{self.aim.azimuth_deg:06.2f}_el{self.aim.elevation_deg:05.2f}")
        if self.exposure_ev:
            parts.append(f"ev{self.exposure_ev:+.1f}")
        if self.repeat:
            parts.append(f"n{self.repeat + 1:02d}")
        return "_".join(parts)

    def as_json(self) -> Mapping[str, Any]:
        """Return the step as plan.jsonl has it: what is as usual is left out."""
        usual = {field.name: field.default for field in fields(self) if field.name not in ("step", "role")}
        return {key: value for key, value in asdict(self).items() if key not in usual or value != usual[key]}


class Plan(Protocol):
    """A finite sequence of steps; iterating it twice gives the same."""

    @property
    def kind(self) -> str:
        """Name the kind of session."""

    def __len__(self) -> int:
        """Return the number of steps."""

    def __iter__(self) -> Iterator[Step]:
        """Go through the steps."""

    def parameters(self) -> Mapping[str, Any]:
        """Return what the plan was made from, as session.toml has it."""


@dataclass(frozen=True)
class AmcPlan:
    """One frame a slice, S_k slices a turn (the AMC paper, section 5).

    Every angle is the slice's share of one turn, computed from one origin: nothing accumulates.
    """

    slices: int
    kind = "amc"

    def __post_init__(self) -> None:
        """Refuse a plan that no table can be built from."""
        if not FEWEST_SLICES <= self.slices <= MOST_STEPS:
            raise InputError(f"slices: {self.slices} is outside {FEWEST_SLICES}..{MOST_STEPS}; 64 to 512 are usual")

    def __len__(self) -> int:
        """One step a slice."""
        return self.slices

    def __iter__(self) -> Iterator[Step]:
        """Turn from 0° on, counter-clockwise."""
        for s in range(self.slices):
            yield Step(s, angle_deg=360 * s / self.slices)

    def parameters(self) -> Mapping[str, Any]:
        """Return the number of slices."""
        return {"kind": self.kind, "slices": self.slices}


@dataclass(frozen=True)
class PtmPlan:
    """Light directions spread evenly over the part of the hemisphere between two elevations.

    A Fibonacci spiral: equal steps of sin(elevation), turned by the golden angle each.

    Attributes
    ----------
    order : of shooting: a tour that keeps the arm's travel short, or as the spiral has it
    arm : whose travel time counts in the tour; without it ways are as long as their angles
    """

    lights: int
    min_elevation_deg: float = 15.0
    max_elevation_deg: float = 80.0
    order: Literal["tour", "spiral"] = "tour"
    arm: ArmConfig | None = None
    kind = "ptm"

    def __post_init__(self) -> None:
        """Refuse a plan that no PTM can be fitted to."""
        if not FEWEST_LIGHTS <= self.lights <= 2000:
            raise InputError(f"lights: {self.lights} is outside {FEWEST_LIGHTS}..2000; 40 to 80 are usual")
        if not 0 < self.min_elevation_deg < self.max_elevation_deg < 90:
            raise InputError(
                f"elevations: {self.min_elevation_deg:g}..{self.max_elevation_deg:g}° must rise within 0..90°"
            )

    def __len__(self) -> int:
        """One step a light direction."""
        return self.lights

    def __iter__(self) -> Iterator[Step]:
        """Follow the order."""
        for step, index in enumerate(self._order):
            yield Step(step, aim=self._aim(index))

    def travel_s(self) -> float | None:
        """Predict how long the arm travels from the first light to the last; None without an arm.

        Raises
        ------
        OutOfRangeError
            The arm does not reach a light.
        """
        return None if self.arm is None else tour_cost(travel_times_s(self.arm, self._directions_deg()), self._order)

    def parameters(self) -> Mapping[str, Any]:
        """Return number and elevations."""
        return {
            "kind": self.kind,
            "lights": self.lights,
            "min_elevation_deg": self.min_elevation_deg,
            "max_elevation_deg": self.max_elevation_deg,
            "order": self.order,
        }

    def _directions_deg(self) -> list[tuple[float, float]]:
        aims = [self._aim(index) for index in range(self.lights)]
        return [(aim.azimuth_deg, aim.elevation_deg) for aim in aims]

    @cached_property
    def _order(self) -> list[int]:
        if self.order == "spiral":
            return list(range(self.lights))
        directions_deg = self._directions_deg()
        if self.arm is None:
            return short_tour(directions_deg)
        first = int(np.argmin([azimuth_deg for azimuth_deg, _ in directions_deg]))
        return shortest_tour(travel_times_s(self.arm, directions_deg), first)

    def _aim(self, index: int) -> Aim:
        low, high = (math.sin(math.radians(e)) for e in (self.min_elevation_deg, self.max_elevation_deg))
        height = low + (high - low) * (index + 0.5) / self.lights
        return Aim(round(index * GOLDEN_ANGLE_DEG % 360, 3), round(math.degrees(math.asin(height)), 3))
