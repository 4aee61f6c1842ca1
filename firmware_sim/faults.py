"""The mishaps that can be asked for over the side channel, by name."""

from typing import Annotated

from pydantic import Field, validate_call

from firmware_sim.camera.shared_frame import LONGEST_LAG, SharedFrame
from firmware_sim.devices import Devices
from firmware_sim.dynamixel.config import Baud, Degrees, TurntableFaults
from firmware_sim.dynamixel.control_table import Register
from firmware_sim.dynamixel.faults import Delay, DropByte, Duplicate, FlipBit, Foreign, Mute, ReplyFault
from firmware_sim.dynamixel.servo import SHUTDOWN_CAUSES
from firmware_sim.grbl.faults import grbl_faults
from firmware_sim.side_channel import Answer, Handler
from firmware_sim.wire import Wire

Replies = Annotated[int, Field(ge=1, le=100_000)]


def turntable_faults(devices: Devices) -> dict[str, Handler]:
    """Return what can befall the servo, its replies, and the table on it."""
    servo, faults = devices.servo, devices.bus.faults

    def befall(fault: ReplyFault, replies: int) -> Answer:
        faults.add(fault, replies)
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
    def drop_byte(byte: Annotated[int, Field(ge=0)], replies: Replies = 1, heard: bool = False) -> Answer:
        """Lose one byte of the next replies, or of the next packets that the servo hears."""
        if heard:
            faults.lose_heard(byte, replies)
            return {}
        return befall(DropByte(byte), replies)

    @validate_call
    def duplicate(replies: Replies = 1, seconds: Annotated[float, Field(ge=0, le=60)] = 0.0) -> Answer:
        """Send the next replies twice."""
        return befall(Duplicate(seconds), replies)

    @validate_call
    def wrong_id(replies: Replies = 1, alone: bool = True) -> Answer:
        """Let another servo speak instead of this one, or before it."""
        return befall(Foreign(alone), replies)

    @validate_call
    def echo(on: bool = True) -> Answer:
        """Let the host hear itself."""
        faults.echo = on
        return {}

    @validate_call
    def id_clash(on: bool = True) -> Answer:
        """Let a second servo have the same id."""
        faults.clash = on
        return {}

    @validate_call
    def shares(**shares: float | bool) -> Answer:
        """Let shares of all replies be struck, by the names of [turntable.faults]."""
        faults.spread(TurntableFaults.model_validate(shares))
        return {}

    @validate_call
    def listen_at(baud: Baud) -> Answer:
        """Let the servo listen at another speed."""
        devices.listen_at(baud)
        return {}

    @validate_call
    def hardware_error(bits: Annotated[int, Field(ge=1, le=SHUTDOWN_CAUSES)]) -> Answer:
        """Raise bits of register 70, and with them the alert bit."""
        servo.fail_hardware(bits)
        return {}

    @validate_call
    def feel(
        volts: Annotated[float, Field(ge=0, le=30)] | None = None,
        deg_c: Annotated[int, Field(ge=0, le=120)] | None = None,
    ) -> Answer:
        """Change supply or temperature; beyond the servo's limits they are hardware errors."""
        servo.feel(volts=volts, deg_c=deg_c)
        return {}

    @validate_call
    def stall(stalled: bool = True, overload_after_s: Annotated[float, Field(gt=0)] | None = None) -> Answer:
        """Block the shaft, or let it go; a motor that pushes for long is overloaded."""
        servo.overload_after_s = overload_after_s
        servo.stall(stalled=stalled)
        return {}

    @validate_call
    def overshoot(degrees: Degrees) -> Answer:
        """Let the shaft swing about its goals."""
        servo.overshoot_deg = degrees
        return {}

    @validate_call
    def slip(degrees: Degrees) -> Answer:
        """Turn the table on its shaft."""
        devices.table.slip_deg += degrees
        return {}

    @validate_call
    def play(degrees: Annotated[float, Field(ge=0, le=30)]) -> Answer:
        """Let the table lag behind its shaft."""
        devices.table.play_deg = degrees
        return {}

    @validate_call
    def brown_out(turned_deg: Degrees = 0.0) -> Answer:
        """Let the supply sag: the servo starts anew, perhaps turned by its load."""
        servo.brown_out(turned_deg)
        return {}

    @validate_call
    def torque_off() -> Answer:
        """Let another program switch its torque off."""
        servo.write(Register.TORQUE_ENABLE, bytes([0]))
        return {}

    @validate_call
    def mend() -> Answer:
        """Forget the mishaps of the wire, and free the shaft."""
        faults.clear()
        servo.stall_at_deg, servo.overshoot_deg = None, 0.0
        devices.table.play_deg = devices.table.slip_deg = 0.0
        return stall(stalled=False)

    wire = (mute, delay, flip_bit, drop_byte, duplicate, wrong_id, echo, id_clash, shares, listen_at)
    shaft = (hardware_error, feel, stall, overshoot, slip, play, brown_out, torque_off, mend)
    return {f"turntable.{handler.__name__}": handler for handler in (*wire, *shaft)}


def plug_faults(name: str, wire: Wire) -> dict[str, Handler]:
    """Return what can befall the USB adapter of a serial port."""

    @validate_call
    def unplug() -> Answer:
        """Pull it out."""
        wire.unplug()
        return {}

    @validate_call
    def replug() -> Answer:
        """Plug it in again, under another name."""
        return {"port": wire.replug()}

    return {f"{name}.{handler.__name__}": handler for handler in (unplug, replug)}


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

    @validate_call
    def lag(frames: Annotated[int, Field(ge=0, le=LONGEST_LAG)]) -> Answer:
        """Hand over what was taken so many frames ago, as if it were new."""
        shared["lag_frames"] = frames
        return {}

    @validate_call
    def cut(percent: Annotated[int, Field(ge=0, le=100)]) -> Answer:
        """Lose the end of each picture."""
        shared["lost_percent"] = percent
        return {}

    @validate_call
    def drift(
        gain: Annotated[int, Field(ge=0, le=100)] | None = None,
        exposure_100us: Annotated[int, Field(ge=1, le=5000)] | None = None,
        white_balance_k: Annotated[int, Field(ge=2800, le=6500)] | None = None,
        focus: Annotated[int, Field(ge=0, le=255)] | None = None,
    ) -> Answer:
        """Change controls behind the client's back."""
        wanted = {"gain": gain, "exposure_100us": exposure_100us, "white_balance_k": white_balance_k, "focus": focus}
        for name, value in wanted.items():
            if value is not None:
                shared[name] = value
        return {}

    @validate_call
    def mend() -> Answer:
        """Be well again; controls stay as they are."""
        for name in ("hang", "unplugged", "frozen", "lag_frames", "lost_percent"):
            shared[name] = 0
        return {}

    switches = {"hang": switch("hang"), "unplug": switch("unplugged"), "freeze": switch("frozen")}
    handlers: dict[str, Handler] = {**switches, "lag": lag, "cut": cut, "drift": drift, "mend": mend}
    return {f"camera.{name}": handler for name, handler in handlers.items()}
