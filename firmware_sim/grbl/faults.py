"""The mishaps of a GRBL controller that can be asked for over the side channel."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from pydantic import Field, validate_call

from firmware_sim.errors import SimError
from firmware_sim.grbl.config import AxisLetter
from firmware_sim.grbl.homing import SwitchFault
from firmware_sim.grbl.wire_faults import FaultyWire
from firmware_sim.side_channel import Answer, Handler

Lines = Annotated[int, Field(ge=1, le=100_000)]
Seconds = Annotated[float, Field(gt=0, le=60)]


def grbl_faults(name: str, wire: FaultyWire) -> dict[str, Handler]:
    """Return what can befall a controller, its motors and its cable, by names that begin with `name`."""
    controller = wire.controller

    @validate_call
    def switches(fault: SwitchFault) -> Answer:
        """Let all limit switches read pressed, or never pressed, or mend them."""
        controller.break_switches(fault)
        return {}

    @validate_call
    def mute(lines: Lines = 1) -> Answer:
        """Lose the next lines from the controller."""
        wire.mute = lines
        return {}

    @validate_call
    def garble(lines: Lines = 1, bit: Annotated[int, Field(ge=0)] = 3) -> Answer:
        """Flip a bit of each of the next lines, another one each time."""
        wire.garble, wire.bit = lines, bit
        return {}

    @validate_call
    def delay(seconds: Seconds, lines: Lines = 1) -> Answer:
        """Let the next lines come late, and what is said meanwhile behind them."""
        wire.delay, wire.delay_s = lines, seconds
        return {}

    @validate_call
    def duplicate(lines: Lines = 1) -> Answer:
        """Let the next lines come twice."""
        wire.duplicate = lines
        return {}

    @validate_call
    def drop_byte(after: Annotated[int, Field(ge=0)] = 0, count: Lines = 1) -> Answer:
        """Lose bytes from the host, after so many that arrive."""
        wire.drop_heard(after, count)
        return {}

    @validate_call
    def stall(axis: AxisLetter, stalled: bool = True) -> Answer:
        """Block a shaft, or let it go; the controller counts on."""
        with _known_axis(axis):
            controller.block_shaft(axis, blocked=stalled)
        return {}

    @validate_call
    def lose_steps(axis: AxisLetter, degrees: Annotated[float, Field(ge=-720, le=720)]) -> Answer:
        """Let an axis stand behind its count."""
        with _known_axis(axis):
            controller.lose_steps(axis, degrees)
        return {}

    @validate_call
    def door(is_open: bool = True) -> Answer:
        """Open the safety door, or close it."""
        controller.set_door(is_open=is_open)
        return {}

    @validate_call
    def power_loss(seconds: Seconds = 0.3) -> Answer:
        """Cut the supply of controller and motors for a while; the adapter stays."""
        controller.lose_power(seconds)
        return {}

    @validate_call
    def lamp_dead(dead: bool = True) -> Answer:
        """Let the lamp on the spindle output shine no more, or again."""
        controller.lamp.is_dead = dead
        return {}

    @validate_call
    def mend() -> Answer:
        """Mend switches, shafts, lamp and cable."""
        wire.clear()
        controller.mend()
        return {}

    wire_mishaps = (mute, garble, delay, duplicate, drop_byte)
    handlers = (switches, *wire_mishaps, stall, lose_steps, door, power_loss, lamp_dead, mend)
    return {f"{name}.{handler.__name__}": handler for handler in handlers}


@contextmanager
def _known_axis(axis: str) -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        raise SimError(f"this controller has no axis {axis}") from error
