"""The `[lights]` of a uDMX controller in RIG.toml: which dimmer channel is which lamp, and where each lamp hangs."""

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from litrig.base.config import StrictModel
from litrig.base.directions import angles_from_direction
from litrig.base.errors import ConfigError
from litrig.base.light_files import read_lights
from rig.sections import LightsSection
from rig.udmx.codec import SLOTS

Channel = Annotated[int, Field(ge=1, le=SLOTS)]
Share = Annotated[float, Field(gt=0, le=1)]
DECIMALS = 4


class UdmxLamp(StrictModel):
    """One lamp of a dome, or any lamp on a dimmer."""

    channels: Annotated[tuple[Channel, ...], Field(min_length=1, max_length=8)]
    """Its DMX channels, counted from 1 as on the dimmer: one, or one a colour."""
    gain: Share | tuple[Share, ...] = 1.0
    """Share of full power that makes it as bright as the others; one for all channels, or one each."""
    azimuth_deg: float | None = Field(default=None, ge=-360, le=360)
    """Where it shines from in the view frame; left out if the lamp is no part of a dome."""
    elevation_deg: float | None = Field(default=None, ge=-90, le=90)
    """The same, above the picture's plane."""

    @property
    def gains(self) -> tuple[float, ...]:
        """One share of full power a channel."""
        return self.gain if isinstance(self.gain, tuple) else (self.gain,) * len(self.channels)

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if len(self.gains) != len(self.channels):
            raise ValueError(f"{len(self.channels)} channels have {len(self.gains)} gains; give one, or one a channel")
        if (self.azimuth_deg is None) != (self.elevation_deg is None):
            raise ValueError("azimuth_deg and elevation_deg go together; give both, or none")
        return self


class UdmxConfig(LightsSection):
    """Lamps on DMX dimmers behind a uDMX controller."""

    kind: Literal["udmx"]
    """The driver."""
    port: Annotated[str, Field(pattern=r"^\d+-\d+(\.\d+)*$")] | None = None
    """USB socket as `lsusb -t` counts, bus-port, such as 1-2.3; needed only where several uDMX are plugged in."""
    lamp: tuple[UdmxLamp, ...] = ()
    """The lamps; their numbers count from 0 in this order."""
    dome: str | None = None
    """An .lp or .dome file that gives the lamps' directions in their order; without lamps, on channels from 1 on."""
    sixteen_bit: bool = False
    """Whether each channel named is followed by one with the finer eight bits."""
    warm_up_s: float = Field(default=0.05, ge=0, le=600)
    """How long a lamp needs until its light is steady; a DMX frame alone takes 0.023 s."""
    usb_backend: Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")] | None = None
    """Instead of libusb: MODULE:FUNCTION of an installed package, which gives a backend of pyusb."""
    usb_address: str = ""
    """What that function is called with."""

    @property
    def directions_deg(self) -> tuple[tuple[float, float], ...]:
        """Azimuth and elevation of each lamp; empty if they have none."""
        return tuple(
            (lamp.azimuth_deg, lamp.elevation_deg)
            for lamp in self.lamp
            if lamp.azimuth_deg is not None and lamp.elevation_deg is not None
        )

    @property
    def instrument(self) -> str:
        """Say how many lamps there are."""
        return f"{len(self.lamp)} lamps on a uDMX"

    def slots(self, lamp: int) -> tuple[int, ...]:
        """Return the slots of a lamp, counted from 0 as on the wire."""
        width = 2 if self.sixteen_bit else 1
        return tuple(channel - 1 + part for channel in self.lamp[lamp].channels for part in range(width))

    def resolved(self, folder: Path) -> Self:
        """Return the same with the dome's directions in each lamp.

        Raises
        ------
        InputError, FormatError
            The dome's file is missing or damaged.
        ConfigError
            It has another number of lights than RIG.toml has lamps, or more than there are channels.
        """
        if self.dome is None:
            return self
        path = folder / self.dome
        angles = [angles_from_direction(direction) for direction in read_lights(path).directions]
        width = 2 if self.sixteen_bit else 1
        lamps = self.lamp or tuple(UdmxLamp(channels=(1 + i * width,)) for i in range(min(len(angles), SLOTS // width)))
        if len(lamps) != len(angles):
            raise ConfigError(
                f"{path}: {len(angles)} lights for {len(lamps)} lamps; give one [[lights.lamp]] a light, in their order"
            )
        directed = tuple(
            lamp.model_copy(
                update={"azimuth_deg": round(azimuth_deg, DECIMALS), "elevation_deg": round(elevation_deg, DECIMALS)}
            )
            for lamp, (azimuth_deg, elevation_deg) in zip(lamps, angles, strict=True)
        )
        return self.model_copy(update={"lamp": directed, "dome": None})

    @model_validator(mode="after")
    def _lamps_fit_together(self) -> Self:
        if not self.lamp and self.dome is None:
            raise ValueError("no lamps; add [[lights.lamp]], or a dome")
        directed = len(self.directions_deg)
        if directed and (self.dome is not None or directed != len(self.lamp)):
            raise ValueError("give every lamp a direction, or none, or the dome's file instead")
        owners: dict[int, int] = {}
        for number in range(len(self.lamp)):
            for slot in self.slots(number):
                if slot >= SLOTS:
                    raise ValueError(f"lamp {number} needs channel {slot + 1}; there are {SLOTS}")
                if slot in owners:
                    raise ValueError(f"lamps {owners[slot]} and {number} share channel {slot + 1}; give each its own")
                owners[slot] = number
        return self
