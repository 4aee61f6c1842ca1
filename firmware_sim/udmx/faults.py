"""The mishaps of the lamps and their controller that can be asked for over the side channel."""

from typing import Annotated, Literal

from pydantic import Field, validate_call

from firmware_sim.side_channel import Answer, Handler
from firmware_sim.udmx.bus import Mishaps, UsbBus
from firmware_sim.udmx.config import LampNumber
from firmware_sim.udmx.dome import Dome

Count = Annotated[int, Field(ge=1, le=100_000)]
Skipped = Annotated[int, Field(ge=0, le=100_000)]
Seconds = Annotated[float, Field(gt=0, le=60)]


def lights_faults(bus: UsbBus, dome: Dome | None) -> dict[str, Handler]:
    """Return what can befall them; nothing where there is no dome."""
    if dome is None:
        return {}

    @validate_call
    def drop_out(seconds: Seconds = 0.3, transfers: Count = 1, after: Skipped = 0, forgets: bool = True) -> Answer:
        """Drop off the bus in the middle of the next transfers, after letting some through; come back by itself."""
        bus.mishaps = Mishaps(after=after, drop_outs=transfers, away_s=seconds, forgets=forgets)
        return {}

    @validate_call
    def stall(transfers: Count = 1, after: Skipped = 0) -> Answer:
        """Stall the next transfers."""
        bus.mishaps = Mishaps(after=after, stalls=transfers)
        return {}

    @validate_call
    def refuse(code: Literal[1, 2], transfers: Count = 1, after: Skipped = 0) -> Answer:
        """Answer the next transfers with an error byte."""
        bus.mishaps = Mishaps(after=after, refusals=transfers, code=code)
        return {}

    @validate_call
    def unplug(on: bool = True) -> Answer:
        """Pull the plug, or put it in again."""
        if on:
            bus.leave(bus.lamps, 0.0, forgets=True)
        bus.lamps.unplugged = on
        return {}

    @validate_call
    def rename(product: Annotated[str, Field(min_length=1, max_length=30)]) -> Answer:
        """Let it call itself something else."""
        bus.lamps.controller.product = product
        return {}

    @validate_call
    def swap(one: LampNumber, other: LampNumber) -> Answer:
        """Exchange the wires of two lamps."""
        dome.swap(one, other)
        return {}

    @validate_call
    def dead(lamp: LampNumber) -> Answer:
        """Let a lamp shine no more."""
        dome.kill(lamp)
        return {}

    @validate_call
    def mend() -> Answer:
        """Forget what waits, plug it in, mend lamps and wires."""
        bus.mishaps = Mishaps()
        bus.lamps.unplugged = False
        dome.mend()
        return {}

    handlers = (drop_out, stall, refuse, unplug, rename, swap, dead, mend)
    return {f"lights.{handler.__name__}": handler for handler in handlers}
