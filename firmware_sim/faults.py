"""The mishaps that can be asked for over the side channel, by name."""

from typing import Annotated

from pydantic import Field, validate_call

from firmware_sim.camera.shared_frame import SharedFrame
from firmware_sim.devices import Devices
from firmware_sim.dynamixel.faults import Delay, FlipBit, Mute, ReplyFault
from firmware_sim.dynamixel.servo import SHUTDOWN_CAUSES
from firmware_sim.grbl.faults import grbl_faults
from firmware_sim.side_channel import Answer, Handler

Replies = Annotated[int, Field(ge=1, le=100_000)]


def turntable_faults(devices: Devices) -> dict[str, Handler]:
    """Return what can befall the servo and its replies."""

    def befall(fault: ReplyFault, replies: int) -> Answer:
        devices.bus.faults.add(fault, replies)
        return {}

    @validate_call
    def mute(replies: Replies = 1) -> Answer:
        """Lose the next replies."""
        return befall(Mute(), replies)

    @validate_call
    def delay(seconds: Annotated[float, Field(gt=0, le=60)], replies: Replies = 1) -> Answer:
        """Send the next replies late."""
        return befall(Delay(seconds), replies)

    @validate_call
    def flip_bit(bit: Annotated[int, Field(ge=0)], replies: Replies = 1) -> Answer:
        """Change one bit of the next replies."""
        return befall(FlipBit(bit), replies)

    @validate_call
    def hardware_error(bits: Annotated[int, Field(ge=1, le=SHUTDOWN_CAUSES)]) -> Answer:
        """Raise bits of register 70, and with them the alert bit."""
        devices.servo.fail_hardware(bits)
        return {}

    @validate_call
    def stall(stalled: bool = True) -> Answer:
        """Block the shaft, or let it go."""
        devices.servo.stall(stalled=stalled)
        return {}

    @validate_call
    def mend() -> Answer:
        """Forget the mishaps that wait for a reply, and free the shaft."""
        devices.bus.faults.clear()
        devices.servo.stall(stalled=False)
        return {}

    handlers = (mute, delay, flip_bit, hardware_error, stall, mend)
    return {f"turntable.{handler.__name__}": handler for handler in handlers}


def arm_faults(devices: Devices) -> dict[str, Handler]:
    """Return what can befall the light arm, and a stepper turntable that has a controller of its own."""
    table = {} if devices.grbl.table is None else grbl_faults("stepper", devices.grbl.table)
    return grbl_faults("arm", devices.grbl.arm) | table


def camera_faults(shared: SharedFrame) -> dict[str, Handler]:
    """Return what can befall the camera: each is a switch in the shared memory."""

    def switch(field: str) -> Handler:
        @validate_call
        def turn(on: bool = True) -> Answer:
            shared[field] = int(on)
            return {}

        return turn

    return {
        "camera.hang": switch("hang"),
        "camera.unplug": switch("unplugged"),
        "camera.freeze": switch("frozen"),
    }
