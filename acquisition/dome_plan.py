"""What to shoot on a dome: lamps that hang where they hang."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition.plans import FEWEST_LIGHTS, Aim, Step
from litrig.base.directions import direction_from_angles
from litrig.base.errors import InputError


@dataclass(frozen=True)
class DomePlan:
    """One frame a lamp of a dome, or of as many of its lamps as are wanted, spread evenly.

    Parameters
    ----------
    lights : how many lamps
    directions_deg : azimuth and elevation of each lamp of the dome, view frame
    """

    lights: int
    directions_deg: tuple[tuple[float, float], ...]
    kind = "ptm"

    def __post_init__(self) -> None:
        """Refuse a plan that no PTM can be fitted to, or more lamps than there are."""
        if not FEWEST_LIGHTS <= self.lights <= len(self.directions_deg):
            raise InputError(
                f"lights: {self.lights} is outside {FEWEST_LIGHTS}..{len(self.directions_deg)}; the rig's dome has "
                f"{len(self.directions_deg)} lamps"
            )

    def __len__(self) -> int:
        """One step a lamp."""
        return self.lights

    def __iter__(self) -> Iterator[Step]:
        """Go through the lamps by their numbers."""
        for step, lamp in enumerate(self._lamps()):
            yield Step(step, aim=Aim(*self.directions_deg[lamp], lamp))

    def parameters(self) -> Mapping[str, Any]:
        """Return which lamps."""
        return {"kind": self.kind, "lights": self.lights, "lamps": self._lamps()}

    def _lamps(self) -> list[int]:
        """Choose lamps that lie far apart: each next one is the farthest from all before, from the highest lamp on."""
        directions = np.array([direction_from_angles(*angles) for angles in self.directions_deg])
        chosen = [int(np.argmax(directions[:, 2]))]
        nearness = directions @ directions[chosen[0]]
        while len(chosen) < self.lights:
            nearness[chosen] = np.inf
            chosen.append(int(np.argmin(nearness)))
            nearness = np.maximum(nearness, directions @ directions[chosen[-1]])
        return sorted(chosen)
