"""Lights that were added to a MatCap by hand. They are kept as what they are, not as texels.

A light stands in the frame of its component's maps, as sharp as it was painted. The material's filter blurs it when
maps are made of it, so that a rougher or shinier material shows it rougher or sharper (the MatCap paper, section 5.2).
"""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, model_validator

from litrig.base.config import StrictModel

F32 = NDArray[np.float32]
Strength = Annotated[float, Field(ge=-1e30, le=1e30)]
"""Of light. Maps are of 32 bits, and end at 3e38."""
LightColour = tuple[Strength, Strength, Strength]
Angle = Annotated[float, Field(ge=-1e6, le=1e6)]
"""In degrees; of larger numbers of turns floats keep too little."""
Degrees = Annotated[float, Field(gt=0, le=180)]


def _leads_somewhere(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not 0.5 < np.linalg.norm(direction) < 2:
        raise ValueError("a direction is a vector of length 1")
    return direction


Direction = Annotated[tuple[float, float, float], AfterValidator(_leads_somewhere)]


class _Light(StrictModel):
    colour: LightColour
    """Linear; negative takes light away."""


class Spot(_Light):
    """A Gaussian."""

    shape: Literal["spot"] = "spot"
    direction: Direction
    size_deg: Degrees
    """Its standard deviation."""


class Disc(_Light):
    """Even, with a sharp edge."""

    shape: Literal["disc"] = "disc"
    direction: Direction
    size_deg: Degrees
    """Its radius."""


class Line(_Light):
    """A tube: a Gaussian across, even along."""

    shape: Literal["line"] = "line"
    start: Direction
    end: Direction
    size_deg: Degrees
    """Standard deviation across."""

    @model_validator(mode="after")
    def _has_ends(self) -> "Line":
        if np.linalg.norm(np.cross(self.start, self.end)) < 1e-6:
            raise ValueError("a line needs two ends that are neither the same nor opposite")
        return self


class Edge(_Light):
    """Even over half of all directions: those within 90 degrees of its pole."""

    shape: Literal["edge"] = "edge"
    pole: Direction


class Picture(_Light):
    """A bitmap that hangs in a direction; `colour` multiplies it."""

    shape: Literal["picture"] = "picture"
    direction: Direction
    size_deg: Degrees
    """Across its width."""
    turn_deg: Angle = 0.0
    """Counter-clockwise as it is seen in the MatCap; at 0 its upper side is towards y."""
    name: str = ""
    """What it is called when it is moved."""


Light = Spot | Disc | Line | Edge


@dataclass(frozen=True)
class Hung:
    """A picture and where it hangs.

    Attributes
    ----------
    texels : (H, W, 4) float32, linear light and straight coverage 0..1, row 0 on top
    """

    picture: Picture
    texels: F32
