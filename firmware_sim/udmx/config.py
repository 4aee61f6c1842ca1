"""What SIM.toml says of a dome: how many lamps, where, and what is wrong with them."""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

MOST_SLOTS = 512
LampNumber = Annotated[int, Field(ge=0, lt=MOST_SLOTS)]


class DomeSim(BaseModel):
    """Lamps spread evenly over a dome, on a uDMX controller."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)

    lamps: int = Field(default=24, ge=1, le=MOST_SLOTS)
    """How many."""
    min_elevation_deg: float = Field(default=15.0, ge=0, lt=90)
    """Elevation of the lowest."""
    max_elevation_deg: float = Field(default=75.0, gt=0, le=90)
    """Elevation of the highest."""
    unevenness: float = Field(default=0.3, ge=0, le=0.9)
    """How much darker the darkest lamp is than the brightest, at the same value; RIG.toml's gains make up for it."""
    sixteen_bit: bool = False
    """Whether the dimmers take two slots a lamp."""
    product: str = Field(default="uDMX", min_length=1, max_length=30)
    """What the controller calls itself."""
    neighbour: Literal["none", "stranger", "udmx"] = "stranger"
    """What else of the same vendor and product number is plugged in: nothing, another hobby device, a second uDMX."""
    drop_out_every: int = Field(default=0, ge=0)
    """After how many transfers the controller drops off the bus in the middle of one; 0 for never."""
    drop_out_s: float = Field(default=0.3, gt=0, le=60)
    """How long it is away then."""
    drop_out_forgets: bool = True
    """Whether it lost its power too, so that all lamps are dark; else it holds the lamps as far as it had heard."""
    stall_every: int = Field(default=0, ge=0)
    """After how many transfers it stalls one; 0 for never."""
    swapped: tuple[LampNumber, LampNumber] | None = None
    """Two lamps whose wires are exchanged."""
    dead: tuple[LampNumber, ...] = ()
    """Lamps that do not light."""

    @property
    def slots_a_lamp(self) -> int:
        return 2 if self.sixteen_bit else 1

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if not self.min_elevation_deg < self.max_elevation_deg:
            raise ValueError("min_elevation_deg must lie below max_elevation_deg")
        if self.lamps * self.slots_a_lamp > MOST_SLOTS:
            raise ValueError(f"{self.lamps} lamps need more than {MOST_SLOTS} slots")
        if any(lamp >= self.lamps for lamp in (*self.dead, *(self.swapped or ()))):
            raise ValueError(f"dead or swapped: there are lamps 0..{self.lamps - 1} only")
        return self
