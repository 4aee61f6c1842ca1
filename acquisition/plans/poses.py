"""Poses: which angles of the turntable under which lights, in which order."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from acquisition.plans.light_path import LightPath
from acquisition.plans.limits import FEWEST_LIGHTS, FEWEST_SLICES, MOST_LIGHTS, MOST_STEPS, check_range
from acquisition.plans.step import Aim
from acquisition.plans.turn import Turn
from litrig.base.capture_folder.capture import Role


class Pose(NamedTuple):
    """Where everything stands for frames of one role; None leaves a part alone."""

    role: Role
    angle_deg: float | None
    aim: Aim | None


class PoseSequence(Protocol):
    """A finite sequence of poses of the roles frame and closure; iterating it twice gives the same."""

    @property
    def kind(self) -> str:
        """Name the kind of session."""

    @property
    def turn(self) -> Turn | None:
        """The angles of the turntable; None if it is left alone."""

    @property
    def aims(self) -> tuple[Aim, ...]:
        """Every light in the order of shooting; empty if the lights are left alone."""

    def __len__(self) -> int:
        """Return the number of poses."""

    def __iter__(self) -> Iterator[Pose]:
        """Go through the poses."""

    def parameters(self) -> Mapping[str, Any]:
        """Return what they were made from, as session.toml has it."""


@dataclass(frozen=True)
class AmcPoses:
    """The sample turned under lights that are left alone (the AMC paper, section 5)."""

    turn: Turn
    kind = "amc"

    def __post_init__(self) -> None:
        """Refuse a turn that no table can be built from."""
        check_range("slices", self.turn.slices, FEWEST_SLICES, MOST_STEPS, "64 to 512 are usual")

    @property
    def aims(self) -> tuple[Aim, ...]:
        """No light is the plan's to move."""
        return ()

    def __len__(self) -> int:
        """One pose an angle, and the closure."""
        return len(self.turn) + self.turn.closure

    def __iter__(self) -> Iterator[Pose]:
        """Turn from the start on, counter-clockwise."""
        for angle_deg in self.turn:
            yield Pose(Role.FRAME, angle_deg, None)
        if self.turn.closure:
            yield Pose(Role.CLOSURE, self.turn.closing_deg, None)

    def parameters(self) -> Mapping[str, Any]:
        """Return the turn."""
        return self.turn.parameters()


@dataclass(frozen=True)
class PtmPoses:
    """A still sample under one light after the other."""

    lights: LightPath
    kind = "ptm"

    def __post_init__(self) -> None:
        """Refuse fewer lights than a PTM can be fitted to."""
        check_range("lights", len(self.aims), FEWEST_LIGHTS, MOST_LIGHTS, "40 to 80 are usual")

    @property
    def turn(self) -> Turn | None:
        """The turntable is left alone."""
        return None

    @property
    def aims(self) -> tuple[Aim, ...]:
        """Every light."""
        return self.lights.aims

    def __len__(self) -> int:
        """One pose a light."""
        return len(self.aims)

    def __iter__(self) -> Iterator[Pose]:
        """Follow the lights' order."""
        for aim in self.aims:
            yield Pose(Role.FRAME, None, aim)

    def parameters(self) -> Mapping[str, Any]:
        """Return how the lights were chosen."""
        return {"lights": len(self.aims), **self.lights.made_from}


@dataclass(frozen=True)
class ProductPoses:
    """Every slice under every light, which keeps its place in the view frame while the sample turns.

    The table turns in the outer loop. The lights are gone through forwards and backwards in turn, so that no way leads
    back to the first of them.
    """

    turn: Turn
    lights: LightPath
    kind = "product"

    @property
    def aims(self) -> tuple[Aim, ...]:
        """Every light, in the order of the first slice."""
        return self.lights.aims

    def __len__(self) -> int:
        """Slices times lights, and the closure."""
        return len(self.turn) * len(self.aims) + self.turn.closure

    def __iter__(self) -> Iterator[Pose]:
        """Turn outside, light inside."""
        for number, angle_deg in enumerate(self.turn):
            for aim in self.aims if number % 2 == 0 else reversed(self.aims):
                yield Pose(Role.FRAME, angle_deg, aim)
        if self.turn.closure:
            yield Pose(Role.CLOSURE, self.turn.closing_deg, self.aims[0])

    def parameters(self) -> Mapping[str, Any]:
        """Return the turn, and how the lights were chosen."""
        return {**self.turn.parameters(), "lights": len(self.aims), **self.lights.made_from}
