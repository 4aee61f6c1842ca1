"""What may go wrong with the servo from the start, as SIM.toml says it."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Baud = Literal[9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000]
Share = Annotated[float, Field(ge=0, le=1)]
Degrees = Annotated[float, Field(ge=-360, le=360)]
Instant = Annotated[float, Field(ge=0)]


class TurntableFaults(BaseModel):
    """Mishaps of the servo, its wire and the table on it; the side channel has the same as switches."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)

    flip: Share = 0.0
    """Share of the replies with a wrong bit."""
    drop: Share = 0.0
    """Share of the replies that lose a byte."""
    mute: Share = 0.0
    """Share of the replies that are lost."""
    duplicate: Share = 0.0
    """Share of the replies that come twice."""
    delay: Share = 0.0
    """Share of the replies that come late."""
    delay_s: float = Field(default=0.1, gt=0, le=60)
    """How late."""
    foreign: Share = 0.0
    """Share of the replies before which another servo says something."""
    wrong_id: Share = 0.0
    """Share of the replies that bear another servo's id."""
    seed: int = Field(default=1, ge=0)
    """Seed of all these shares."""
    echo: bool = False
    """Whether the host hears itself, as on a half-duplex wire."""
    id_clash: bool = False
    """Whether a second servo has the same id, so that two talk at once."""
    listens_at: Baud | None = None
    """The speed that it truly listens at, if it is not the one that RIG.toml says."""
    model_number: int | None = Field(default=None, ge=0, le=65_535)
    """What it says it is, if not an XL430-W250 (1060)."""
    firmware: int | None = Field(default=None, ge=0, le=255)
    """Its firmware version, if not 45; before 38 there was no bus watchdog."""
    groups: bool = True
    """Whether it understands broadcast pings, and sync, bulk and fast instructions."""
    alert_bits: int = Field(default=0, ge=0, le=0b0011_1101)
    """Bits of its hardware error status that are set from the start."""
    stall_at_deg: float | None = None
    """Shaft angle at which it is blocked."""
    overload_after_s: float | None = Field(default=None, gt=0)
    """How long it pushes against a block before it shuts down with an overload; never if left out."""
    overshoot_deg: Degrees = 0.0
    """How far the shaft swings beyond each goal before it comes to rest."""
    slip_deg: Degrees = 0.0
    """How far the table is turned on its shaft."""
    play_deg: float = Field(default=0.0, ge=0, le=30)
    """Play between shaft and table: the table lags behind when the shaft turns up."""
    brown_out_at_s: Instant | None = None
    """When its supply sags, in seconds from the start: it starts anew."""
    unplug_at_s: Instant | None = None
    """When its USB adapter is pulled out."""
    replug_at_s: Instant | None = None
    """When that is plugged in again, under another name."""
