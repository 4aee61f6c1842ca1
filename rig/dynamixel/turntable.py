"""A turntable on a Dynamixel servo in extended position mode: an absolute servo knows where it is."""

import math

from rig.clock import Clock
from rig.config import TurntableConfig
from rig.devices import TurntablePose
from rig.dynamixel import registers
from rig.dynamixel.link import DynamixelLink
from rig.errors import DeviceError, OutOfRangeError, PositionLostError

POLL_S = 0.005
SETTLED_READS = 2
GRACE_S = 2.0


class DynamixelTurntable:
    """Fits `rig.devices.Turntable`."""

    def __init__(self, link: DynamixelLink, config: TurntableConfig, clock: Clock) -> None:
        self._link, self._config, self._clock = link, config, clock
        self._commanded_deg: float | None = None
        self._ready = False

    def home(self) -> None:
        """Check that it is the servo of RIG.toml and healthy, set mode and profile, switch torque on. Nothing moves.

        Raises
        ------
        DeviceError
            Another model, or a hardware error that a person must clear.
        """
        self._check_model()
        self._check_hardware()
        if self._link.read(registers.OPERATING_MODE) != registers.EXTENDED_POSITION_MODE:
            self._link.write(registers.TORQUE_ENABLE, 0)  # the mode is locked while torque is on
            self._link.write(registers.OPERATING_MODE, registers.EXTENDED_POSITION_MODE)
        ratio = self._config.gear_ratio
        acceleration = registers.acceleration_units(self._config.acceleration_deg_s2 * ratio)
        self._link.write(registers.PROFILE_ACCELERATION, acceleration)
        self._link.write(registers.PROFILE_VELOCITY, registers.velocity_units(self._config.speed_deg_s * ratio))
        self._link.write(registers.TORQUE_ENABLE, 1)
        self._ready = True

    def check(self, angle_deg: float) -> None:
        """Refuse an angle outside the limits of RIG.toml."""
        config = self._config
        if not config.min_deg <= angle_deg <= config.max_deg:  # so written, NaN is refused too
            raise OutOfRangeError(
                f"turntable: {angle_deg:g}° is outside {config.min_deg:g}..{config.max_deg:g}°; nothing moved. "
                "Ask for an angle inside, or widen min_deg and max_deg in RIG.toml if the cables allow."
            )

    def move_to(self, angle_deg: float) -> TurntablePose:
        """Go to an angle, from below by at least the backlash, and wait until the servo stands there.

        Raises
        ------
        OutOfRangeError
            Beyond the limits of RIG.toml; nothing moved.
        DeviceError, PositionLostError, LinkError
            The servo did not arrive, reports a fault, lost torque, or is silent.
        """
        config = self._config
        self.check(angle_deg)
        if not self._ready:
            raise DeviceError("turntable: not homed yet; home it first")
        here_deg = self.locate().angle_deg
        arrived = self._commanded_deg == angle_deg and abs(here_deg - angle_deg) <= config.tolerance_deg
        if not arrived and here_deg > angle_deg - config.backlash_deg:
            self._go(max(angle_deg - config.backlash_deg, config.min_deg))
        self._go(angle_deg)
        self._commanded_deg = angle_deg
        return self.locate()

    def locate(self) -> TurntablePose:
        """Read the angle now."""
        return TurntablePose(self._commanded_deg, self._angle_deg(self._link.read(registers.PRESENT_POSITION)))

    def stop(self) -> None:
        """Hold where it is now; torque stays on, for a sample on a tilted table must not slip."""
        self._link.drain()
        self._link.write(registers.GOAL_POSITION, self._link.read(registers.PRESENT_POSITION))

    def release(self) -> None:
        """Switch torque off."""
        self._link.write(registers.TORQUE_ENABLE, 0)
        self._ready = False

    def close(self) -> None:
        """Give the port back."""
        self._link.close()

    def _go(self, angle_deg: float) -> None:
        goal = self._ticks(angle_deg)
        way_deg = (goal - self._link.read(registers.PRESENT_POSITION)) * registers.DEG_PER_TICK
        ratio = self._config.gear_ratio
        needed_s = registers.profile_time_s(
            way_deg, self._config.speed_deg_s * ratio, self._config.acceleration_deg_s2 * ratio
        )
        self._link.write(registers.GOAL_POSITION, goal)
        deadline_s = self._clock.now_s() + 1.5 * needed_s + GRACE_S
        settled = 0
        while settled < SETTLED_READS:
            settled = settled + 1 if self._stands_at(angle_deg) else 0
            if not settled and self._clock.now_s() > deadline_s:
                self._give_up(angle_deg)
            self._clock.sleep(POLL_S)
        self._check_torque()

    def _stands_at(self, angle_deg: float) -> bool:
        off_deg = abs(self.locate().angle_deg - angle_deg)
        return off_deg <= self._config.tolerance_deg and not self._link.read(registers.MOVING)

    def _give_up(self, angle_deg: float) -> None:
        self._check_hardware()
        self._check_torque()
        at_deg = self.locate().angle_deg
        raise DeviceError(
            f"turntable: told to go to {angle_deg:.2f}°, stands at {at_deg:.2f}°; look what blocks it, then run again"
        )

    def _check_model(self) -> None:
        number = self._link.ping()
        expected = registers.MODEL_NUMBERS.get(self._config.model)
        if expected is None:
            known = ", ".join(registers.MODEL_NUMBERS)
            raise DeviceError(f"turntable: model {self._config.model!r} in RIG.toml is unknown; one of {known}")
        if number != expected:
            found = {n: name for name, n in registers.MODEL_NUMBERS.items()}.get(number, f"model number {number}")
            raise DeviceError(
                f"{self._link.name}: is a {found}, RIG.toml says {self._config.model}; mend the model or the id"
            )

    def _check_hardware(self) -> None:
        status = self._link.read(registers.HARDWARE_ERROR)
        if status:
            raise DeviceError(
                f"{self._link.name}: hardware error: {registers.hardware_errors(status)}; remove the cause, then "
                "switch the servo's power off and on"
            )

    def _check_torque(self) -> None:
        if not self._link.read(registers.TORQUE_ENABLE):
            self._ready = False
            raise PositionLostError(
                f"{self._link.name}: lost its torque on the way (a reboot or a power sag?); check the supply, then home"
            )

    def _ticks(self, angle_deg: float) -> int:
        servo_deg = self._config.zero_deg + self._config.direction * self._config.gear_ratio * angle_deg
        return round(servo_deg / registers.DEG_PER_TICK)

    def _angle_deg(self, ticks: int) -> float:
        servo_deg = ticks * registers.DEG_PER_TICK - self._config.zero_deg
        angle_deg = servo_deg / (self._config.direction * self._config.gear_ratio)
        return 0.0 if math.isclose(angle_deg, 0.0, abs_tol=1e-12) else angle_deg
