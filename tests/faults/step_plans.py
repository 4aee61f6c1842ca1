"""Plans whose steps are made by hand."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.plans import Aim, Step
from litrig.base.capture_folder.capture import Role
from rig.config import RigConfig


@dataclass(frozen=True)
class StepsPlan:
    """Fits `acquisition.session.Planned`."""

    steps: tuple[Step, ...]
    kind = "steps"

    def __len__(self) -> int:
        return len(self.steps)

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)

    def parameters(self) -> Mapping[str, Any]:
        return {"kind": self.kind}


def turn(slices: int) -> StepsPlan:
    """Shoot the slices of one turn."""
    return StepsPlan(tuple(Step(place, angle_deg=360 * place / slices) for place in range(slices)))


def arc(count: int) -> StepsPlan:
    """Shoot poses that are near to each other."""
    return StepsPlan(tuple(Step(place, angle_deg=10.0 * place) for place in range(count)))


def turn_with_revisits(slices: int, every: int) -> StepsPlan:
    """Shoot a turn and look at the first slice again after so many, and at the end of the turn."""
    steps: list[Step] = []
    for place in range(slices):
        if place and place % every == 0:
            steps.append(Step(len(steps), Role.CLOSURE, angle_deg=0.0))
        steps.append(Step(len(steps), angle_deg=360 * place / slices))
    return StepsPlan((*steps, Step(len(steps), Role.CLOSURE, angle_deg=360.0)))


def lights_of_arm(count: int) -> StepsPlan:
    """Bring the arm's lamp round, and up and down."""
    aims = (Aim(330.0 * place / count, 35.0 + 25 * (place % 2)) for place in range(count))
    return StepsPlan(tuple(Step(place, aim=aim) for place, aim in enumerate(aims)))


def lamps_of_dome(config: RigConfig) -> StepsPlan:
    """Light every lamp in turn."""
    assert config.lights is not None
    aims = (Aim(azimuth, elevation, lamp) for lamp, (azimuth, elevation) in enumerate(config.lights.directions_deg))
    return StepsPlan(tuple(Step(place, aim=aim) for place, aim in enumerate(aims)))
