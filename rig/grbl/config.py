"""What RIG.toml says of a turntable on a GRBL controller."""

from typing import Annotated, Literal

from pydantic import Field

from rig.config import Turns
from rig.sections import Port, Positive, TurntableSection


class StepperTurntableConfig(TurntableSection):
    """A turntable on an axis of a GRBL controller, a degree a millimetre."""

    kind: Literal["grbl"]
    """The driver."""
    port: Port
    """Device path of the controller; the arm's, if the table is on one of its axes."""
    baud: int = Field(default=115200, gt=0)
    """GRBL runs at 115200."""
    axis: Literal["X", "Y", "Z", "A", "B", "C"] = "A"
    """Letter of the axis; GRBL itself has X, Y and Z, its relatives up to six."""
    zero: Literal["stands", "switch"] = "stands"
    """Where zero is: where the table stood when the controller was switched on, or where homing finds its switch."""
    origin_deg: Turns = 0.0
    """Machine coordinate of the axis at which the turntable stands at zero."""
    direction: Literal[1, -1] = 1
    """1 if the positive sense of the axis turns the sample counter-clockwise as the camera sees it, else −1."""
    steps_per_deg: float | None = Field(default=None, gt=0)
    """Motor steps for a degree of the table; the controller's $100, $101, … is checked against it."""
    speed_deg_s: float = Field(default=60.0, ge=0.1, le=1000)
    """Speed of the table."""
    tolerance_deg: Positive = 0.1
    """How far the angle read back may be from its goal."""
    backlash_deg: float = Field(default=1.0, ge=0)
    """Play of the gears: a goal is always approached from below by at least this much."""
    park_deg: float = 0.0
    """Where the table rests at the end of a session."""
    homing_timeout_s: Positive = 60.0
    """How long homing may take."""
    settings: dict[Annotated[int, Field(ge=0, le=999)], float] = Field(default_factory=dict)
    """GRBL settings ($ numbers) that the controller must have; those that differ are written when it is opened."""

    @property
    def instrument(self) -> str:
        """Name the axis."""
        return f"turntable on axis {self.axis} of a GRBL controller"
