"""What can be done to a decomposed MatCap, as X.recipe.toml says it (the MatCap paper, section 5)."""

from enum import StrEnum
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from litrig.base.config import StrictModel
from processing.matcap.lights.model import Angle, Degrees, LightColour, Strength

Spot2 = tuple[Annotated[float, Field(ge=-1, le=1)], Annotated[float, Field(ge=-1, le=1)]]
NotNegative = Annotated[float, Field(ge=0, le=1e30)]
Axis = Literal["x", "y", "z"] | tuple[float, float, float]


class Which(StrEnum):
    """A component, or both."""

    LOW = "low"
    HIGH = "high"
    BOTH = "both"


class One(StrEnum):
    """A component."""

    LOW = "low"
    HIGH = "high"


class Turns(StrEnum):
    """What a turn is applied to."""

    LIGHT = "light"
    """The directions that normals show: highlights move, stretch and compress as they do under light that turns."""
    NORMALS = "normals"
    """The normals, before warping, as the MatCap paper's section 5.1 words it: the picture itself turns."""


def _on_ball(spot: Spot2) -> Spot2:
    if np.hypot(*spot) > 1:
        raise ValueError(f"{spot[0]:g}, {spot[1]:g} is not on the ball; keep x² + y² within 1")
    return spot


class _Operation(StrictModel):
    @model_validator(mode="after")
    def _spots_are_on_the_ball(self) -> "_Operation":
        for name in ("at", "to"):
            spot = getattr(self, name, None)
            if spot is not None:
                _on_ball(spot)
        return self


class Rotate(_Operation):
    """Turn the light, of both components together."""

    op: Literal["rotate"] = "rotate"
    axis: Axis
    degrees: Angle
    """Counter-clockwise seen against the axis: about y, what came from the camera goes to the right."""
    turns: Turns = Turns.LIGHT

    @model_validator(mode="after")
    def _has_an_axis(self) -> "Rotate":
        if not isinstance(self.axis, str) and not any(self.axis):
            raise ValueError("an axis of no length turns nothing; give one")
        return self


class Align(_Operation):
    """Turn the light so that the main highlight comes to a spot, or to where another MatCap has its own."""

    op: Literal["align"] = "align"
    at: Spot2 | None = None
    """x and y of the normal that shows it."""
    to_file: str | None = None

    @model_validator(mode="after")
    def _has_one_goal(self) -> "Align":
        if (self.at is None) == (self.to_file is None):
            raise ValueError("give either at or to_file")
        return self


class Paint(_Operation):
    """Add a light where the ball shows it, x and y of the normal there."""

    op: Literal["paint"] = "paint"
    component: One = One.HIGH
    shape: Literal["spot", "disc", "line", "edge"] = "spot"
    at: Spot2
    to: Spot2 | None = None
    """Where a line ends; on which side an edge is bright."""
    size_deg: Degrees = 5.0
    """Standard deviation of a spot, and of a line across; radius of a disc; in the light, where the ball shows half."""
    colour: LightColour = (1.0, 1.0, 1.0)

    @model_validator(mode="after")
    def _goes_somewhere(self) -> "Paint":
        if (self.shape in ("line", "edge")) != (self.to is not None):
            raise ValueError("a line and an edge need `to`, a spot and a disc have none")
        if self.to == self.at:
            raise ValueError("`to` is where `at` is; name two places")
        return self


class Hang(_Operation):
    """Hang a picture into the light."""

    op: Literal["hang"] = "hang"
    component: One = One.HIGH
    image: str
    at: Spot2
    size_deg: Degrees = 30.0
    turn_deg: Angle = 0.0
    colour: LightColour = (1.0, 1.0, 1.0)
    name: str = ""
    """By which it can be moved; what hung under that name before is taken down."""


class Move(_Operation):
    """Move a picture that hangs in the light; what is left out stays."""

    op: Literal["move"] = "move"
    name: str
    at: Spot2 | None = None
    size_deg: Degrees | None = None
    turn_deg: Angle | None = None


class Roughness(_Operation):
    """Make the material rougher or shinier."""

    op: Literal["roughness"] = "roughness"
    component: Which = Which.HIGH
    filter_size: Annotated[float, Field(ge=0, le=10)] | None = None
    """The new ν, a variance in radians squared."""
    degrees: Annotated[float, Field(ge=0, le=180)] | None = None
    """The same, as its square root in degrees."""

    @model_validator(mode="after")
    def _has_one_size(self) -> "Roughness":
        if (self.filter_size is None) == (self.degrees is None):
            raise ValueError("give either filter_size or degrees")
        return self

    @property
    def variance(self) -> float:
        if self.filter_size is not None:
            return self.filter_size
        return float(np.radians(self.degrees or 0.0) ** 2)


class Colour(_Operation):
    """Change the base colour, in HSV of linear light; or name it."""

    op: Literal["colour"] = "colour"
    component: Which = Which.BOTH
    base_colour: tuple[NotNegative, NotNegative, NotNegative] | None = None
    """Linear; the rest is done to it."""
    hue_deg: Angle = 0.0
    """Added."""
    saturation: NotNegative = 1.0
    """A factor; what would be more than pure stays pure."""
    value: NotNegative = 1.0
    """A factor."""


class Gain(_Operation):
    """Scale how much the components give, with their silhouettes."""

    op: Literal["gain"] = "gain"
    low: NotNegative = 1.0
    high: NotNegative = 1.0


class Outline(_Operation):
    """Give the material a silhouette: a cubic from 0 at `start_deg` to `rise` at 90 degrees, of `slope` there."""

    op: Literal["silhouette"] = "silhouette"
    component: Which = Which.BOTH
    start_deg: Annotated[float, Field(ge=0, lt=90)] = 45.0
    rise: Strength = 0.5
    slope: Strength = 0.0


class Take(_Operation):
    """Take a component from another MatCap."""

    op: Literal["take"] = "take"
    component: One
    from_file: str


Operation = Annotated[
    Rotate | Align | Paint | Hang | Move | Roughness | Colour | Gain | Outline | Take, Field(discriminator="op")
]
