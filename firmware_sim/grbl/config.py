"""What SIM.toml says of a GRBL controller: what goes wrong with it, and a turntable on one of its axes."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from firmware_sim.grbl.dialect import DialectName
from firmware_sim.grbl.homing import SwitchFault

Share = Annotated[float, Field(ge=0, le=1)]
Settings = dict[Annotated[int, Field(ge=0, le=999)], Annotated[float, Field(ge=0)]]
AxisLetter = Literal["X", "Y", "Z", "A", "B", "C"]


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class GrblFaults(_Strict):
    """Mishaps that are there from the start; the side channel has more."""

    switches: SwitchFault = "none"
    """Limit switches that read pressed always, or never."""
    mute: Share = 0.0
    """Share of its lines that get lost."""
    garble: Share = 0.0
    """Share of its lines with a flipped bit."""
    drop_byte: Share = 0.0
    """Share of the bytes to it that get lost."""
    delay: Share = 0.0
    """Share of its lines that come late."""
    delay_s: float = Field(default=0.5, gt=0, le=60)
    """By how much."""
    seed: int = Field(default=1, ge=0)
    """Seed of what is struck."""
    power_loss_at_s: float | None = Field(default=None, ge=0)
    """When the supply fails, from the start."""
    power_loss_s: float = Field(default=0.3, gt=0, le=60)
    """For how long."""


class StepperSim(_Strict):
    """A stepper turntable on an axis of a GRBL controller, in place of the servo."""

    axis: AxisLetter = "X"
    """The axis that it hangs on."""
    on_the_arm: bool = False
    """Whether that is an axis of the arm's controller (Z, or A with the dialect grblHAL), or one of its own."""
    dialect: DialectName = "grbl"
    """Firmware of its own controller."""
    steps_per_deg: float = Field(default=88.889, gt=0)
    """Setting $100, $101, … of the axis."""
    start_deg: float = Field(default=0.0, ge=-360, le=360)
    """Where it stands when the power comes on: its zero, unless a switch finds another one."""
    switch_deg: float | None = None
    """Angle of its limit switch; without one it turns for ever and is not homed."""
    settings: Settings = Field(default_factory=dict)
    """Further `$` settings of its own controller."""
    faults: GrblFaults = GrblFaults()
    """What goes wrong with its own controller."""
