"""A turntable on a Dynamixel servo in extended position mode: an absolute servo knows where it is."""

import math
from collections import deque
from dataclasses import replace

from rig.clock import Clock
from rig.config import TurntableConfig
from rig.devices import TurntablePose
from rig.dynamixel import registers
from rig.dynamixel.bus import RefusedError
from rig.dynamixel.health import ServoHealth, complaint, read_health
from rig.dynamixel.link import ServoLink
from rig.dynamixel.models import BUS_WATCHDOG_SINCE, FARTHEST_POSITION, name_of
from rig.dynamixel.registers import Register, Values
from rig.errors import DeviceError, LinkError, OutOfRangeError, PositionLostError

POLL_S = 0.005
SETTLED_READS = 3
STILL_TICKS = 2
"""How far settled reads may lie apart: the last digit flickers."""
LOOK_S = 0.1
STUCK_S = 1.0
GRACE_S = 2.0
PUSHES = 2
WATCHDOG_S = 0.4
LONGEST_SILENCE_S = 0.25
"""What a stop waits for at most, on a wire that does not come to rest."""


class DynamixelTurntable:
    """Fits `rig.devices.Turntable`."""

    def __init__(self, link: ServoLink, config: TurntableConfig, clock: Clock) -> None:
        self._link, self._config, self._clock = link, config, clock
        self._commanded_deg: float | None = None
        self._arrived = False
        self._ready = False
        self._has_watchdog = True
        self._goal: int | None = None
        self._settle_s = 0.0
        self._marks: dict[Register, int] = {}

    def home(self) -> None:
        """Check that it is the servo of RIG.toml and healthy, set mode and profile, switch torque on. Nothing moves.

        Raises
        ------
        DeviceError
            Another model, a speed that it cannot reach, or a hardware error that a person must clear.
        """
        self._ready, self._goal, self._commanded_deg, self._arrived = False, None, None, False
        firmware = self._check_model()
        settings = self._link.read_block(registers.EEPROM)
        self._check_speed(settings)
        state = self._link.read_block(registers.STATE)
        if state[registers.HARDWARE_ERROR]:
            raise DeviceError(f"{self._link.name}: {complaint(state)}")
        self._has_watchdog = firmware >= BUS_WATCHDOG_SINCE
        if self._has_watchdog and state[registers.BUS_WATCHDOG] != registers.WATCHDOG_OFF:
            self._watch(registers.WATCHDOG_OFF)
        if state[registers.TORQUE_ENABLE] and state[registers.MOVING]:
            self.stop()  # whoever set it in motion is gone
        self._set_modes(settings)
        for register, value in self._profile().items():
            self._link.write(register, value)
        self._link.write(registers.TORQUE_ENABLE, 1)
        self._goal = None  # the servo's own choice when torque comes on
        state = self._link.read_block(registers.STATE)
        # What a reset takes away; a servo that has no profile to set must do without these marks.
        self._marks = {register: value for register, value in self._profile().items() if state[register] == value}
        self._verify(state)
        self._ready = True

    def check(self, angle_deg: float) -> None:
        """Refuse an angle outside the limits of RIG.toml, or beyond the turns that the servo counts."""
        config = self._config
        config.check_limits(angle_deg)
        if max(abs(self._ticks(a)) for a in (angle_deg, angle_deg - config.backlash_deg)) > FARTHEST_POSITION:
            raise OutOfRangeError(
                f"turntable: {angle_deg:g}° is beyond the ±256 turns that the servo counts, with gear_ratio "
                f"{config.gear_ratio:g} and zero_deg {config.zero_deg:g} of RIG.toml; nothing moved"
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
        here = self.locate()
        arrived = self._arrived and self._commanded_deg == angle_deg
        if arrived and abs(here.angle_deg - angle_deg) <= config.tolerance_deg:
            return here
        self._commanded_deg, self._arrived = angle_deg, False
        try:
            self._watch(round(WATCHDOG_S / registers.WATCHDOG_UNIT_S))
            if here.angle_deg > angle_deg - config.backlash_deg:
                self._go(angle_deg - config.backlash_deg)
            self._go(angle_deg)
            self._watch(registers.WATCHDOG_OFF)
        except LinkError as error:
            if not self._has_watchdog:
                raise
            raise type(error)(f"{error}. As long as it has power, it stops by itself and keeps its position") from error
        pose = self.locate()
        self._arrived = True
        return replace(pose, settle_s=self._settle_s)

    def locate(self) -> TurntablePose:
        """Read the angle now; once homed, raise if the servo has a fault, or is not as it was left."""
        state = self._link.read_block(registers.STATE)
        if self._ready:
            self._verify(state)
        return TurntablePose(self._commanded_deg, self._angle_deg(state[registers.PRESENT_POSITION]))

    def stop(self) -> None:
        """Hold where it is now; torque stays on, for a sample on a tilted table must not slip.

        After trouble on the wire, raise if the servo turns out to have lost its position or its torque.
        """
        self._arrived = False
        trouble = self._link.uncertain
        try:
            if trouble:
                self._halt_by_silence()
            here = self._link.read_block(registers.MOTION)[registers.PRESENT_POSITION]
            self._watch(registers.WATCHDOG_OFF)  # tripped, it takes no goal
            self._link.write(registers.GOAL_POSITION, here)
            self._goal = here
            if trouble and self._ready:
                self._verify(self._link.read_block(registers.GLANCE))
        except LinkError:
            self._halt_by_silence()
            raise

    def release(self) -> None:
        """Switch torque off."""
        self._link.write(registers.TORQUE_ENABLE, 0)
        self._ready = False

    def health(self) -> ServoHealth:
        """Read supply, temperature and faults; moves nothing, and needs no homing."""
        return read_health(self._link)

    def close(self) -> None:
        """Give the port back."""
        self._link.close()

    # Motion

    def _go(self, angle_deg: float) -> None:
        for _ in range(PUSHES):
            if self._comes_to(angle_deg):
                return
        at_deg = self.locate().angle_deg
        raise DeviceError(
            f"turntable: told to go to {angle_deg:.2f}°, stands at {at_deg:.2f}° (its position is kept); "
            "look what blocks it, then run again"
        )

    def _comes_to(self, angle_deg: float) -> bool:
        """Send the goal, and wait until the servo stands there; False if it does not get on, or takes too long."""
        goal = self._ticks(angle_deg)
        last = self._link.read_block(registers.MOTION)[registers.PRESENT_POSITION]
        self._send(goal)
        now_s = self._clock.now_s()
        deadline_s = now_s + 1.5 * self._time_s(goal - last) + GRACE_S
        patience_s = STUCK_S + self._time_s(STILL_TICKS)
        went_s = looked_s = now_s
        reads: deque[int] = deque(maxlen=SETTLED_READS)
        moved_s = now_s
        while True:
            motion, now_s = self._link.read_block(registers.MOTION), self._clock.now_s()
            here = motion[registers.PRESENT_POSITION]
            if abs(here - last) >= STILL_TICKS:
                last, went_s = here, now_s
            if motion[registers.MOVING]:
                moved_s = now_s
            if self._is_near(here, goal) and not motion[registers.MOVING]:
                reads.append(here)
                if len(reads) == SETTLED_READS and max(reads) - min(reads) <= STILL_TICKS:
                    self._settle_s = now_s - moved_s
                    return True
            else:
                reads.clear()
            if self._link.alert or now_s - max(went_s, looked_s) > LOOK_S:
                looked_s = now_s
                if self._look(goal):
                    went_s = now_s
            if now_s - went_s > patience_s or now_s > deadline_s:
                return False
            self._clock.sleep(POLL_S)

    def _look(self, goal: int) -> bool:
        """See what is the matter; a watchdog that tripped, for this host was too slow, is no reason to give up."""
        state = self._link.read_block(registers.GLANCE)
        self._verify(state)
        tripped = self._has_watchdog and state[registers.BUS_WATCHDOG] == registers.WATCHDOG_TRIPPED
        if tripped:
            self._send(goal)
        return tripped

    def _send(self, goal: int) -> None:
        self._goal = goal
        try:
            self._link.write(registers.GOAL_POSITION, goal)
        except RefusedError:
            if not self._has_watchdog or self._link.read(registers.BUS_WATCHDOG) != registers.WATCHDOG_TRIPPED:
                raise
            self._watch(registers.WATCHDOG_OFF)
            self._link.write(registers.GOAL_POSITION, goal)
            self._watch(round(WATCHDOG_S / registers.WATCHDOG_UNIT_S))

    def _watch(self, value: int) -> None:
        """Arm or disarm the servo's own watchdog, which stops it if this program dies in the middle of a move."""
        if self._has_watchdog:
            try:
                self._link.write(registers.BUS_WATCHDOG, value)
            except RefusedError:
                self._has_watchdog = False

    def _halt_by_silence(self) -> None:
        """Let the watchdog stop the servo in its tracks, for nothing that asks for an answer may come through."""
        if self._has_watchdog:
            self._link.shout(registers.BUS_WATCHDOG, 1)
        self._link.drain(LONGEST_SILENCE_S)

    # What must be so

    def _check_model(self) -> int:
        """Return the firmware version of the right model."""
        found = self._link.ping()
        expected = registers.MODEL_NUMBERS.get(self._config.model)
        if expected is None:
            known = ", ".join(registers.MODEL_NUMBERS)
            raise DeviceError(f"turntable: model {self._config.model!r} in RIG.toml is unknown; one of {known}")
        if found.model_number != expected:
            raise DeviceError(
                f"{self._link.name}: is a {name_of(found.model_number)}, RIG.toml says {self._config.model}; "
                "mend the model or the id"
            )
        return found.firmware

    def _check_speed(self, settings: Values) -> None:
        limit = settings[registers.VELOCITY_LIMIT] * registers.VELOCITY_UNIT_DEG_S
        asked = self._config.speed_deg_s * self._config.gear_ratio
        if 0 < limit < asked:
            raise DeviceError(
                f"{self._link.name}: turns at {limit:.0f}°/s at most (its velocity limit), RIG.toml asks it for "
                f"{asked:.0f}°/s; lower speed_deg_s to {limit / self._config.gear_ratio:.0f} or less"
            )

    def _set_modes(self, settings: Values) -> None:
        """Make it count turns and take speeds for speeds; these settings are locked while torque is on."""
        wanted = {
            registers.OPERATING_MODE: registers.EXTENDED_POSITION_MODE,
            registers.DRIVE_MODE: settings[registers.DRIVE_MODE] & ~registers.TIME_BASED_PROFILE,
        }
        if any(settings[register] != value for register, value in wanted.items()):
            self._link.write(registers.TORQUE_ENABLE, 0)
            for register, value in wanted.items():
                self._link.write(register, value)

    def _profile(self) -> dict[Register, int]:
        ratio = self._config.gear_ratio
        return {
            registers.PROFILE_ACCELERATION: registers.acceleration_units(self._config.acceleration_deg_s2 * ratio),
            registers.PROFILE_VELOCITY: registers.velocity_units(self._config.speed_deg_s * ratio),
        }

    def _verify(self, state: Values) -> None:
        """Raise unless the servo is healthy and as it was left. Then it must be homed again.

        A servo that was without power has forgotten its profile, its torque, and whole turns.
        """
        was_ready, self._ready = self._ready, False
        name = self._link.name
        if any(state[register] != value for register, value in self._marks.items()):
            raise PositionLostError(
                f"{name}: was reset (a power sag or a reboot): torque and whole turns are gone, its position is lost; "
                "check the supply, then home it"
            )
        if state[registers.HARDWARE_ERROR] & registers.ENCODER_FAULT:
            raise PositionLostError(f"{name}: {complaint(state)}")
        if state[registers.HARDWARE_ERROR]:
            raise DeviceError(f"{name}: {complaint(state)}")
        if not state[registers.TORQUE_ENABLE]:
            raise DeviceError(
                f"{name}: its torque was switched off, its position is kept; see what else talks to it, then home it"
            )
        if self._goal is not None and state[registers.GOAL_POSITION] != self._goal:
            raise PositionLostError(
                f"{name}: has a goal that nobody here gave it ({state[registers.GOAL_POSITION]}, not {self._goal}): "
                "it was reset, or another program talks to it; see to that, then home it"
            )
        self._ready = was_ready

    # Angles

    def _is_near(self, here: int, goal: int) -> bool:
        return abs(here - goal) * registers.DEG_PER_TICK <= self._config.tolerance_deg * self._config.gear_ratio

    def _time_s(self, ticks: int) -> float:
        ratio = self._config.gear_ratio
        speed_deg_s, acceleration_deg_s2 = self._config.speed_deg_s * ratio, self._config.acceleration_deg_s2 * ratio
        return registers.profile_time_s(ticks * registers.DEG_PER_TICK, speed_deg_s, acceleration_deg_s2)

    def _ticks(self, angle_deg: float) -> int:
        """Turn a table angle into the servo's count: from one origin, rounded once."""
        servo_deg = self._config.zero_deg + self._config.direction * self._config.gear_ratio * angle_deg
        return round(servo_deg / registers.DEG_PER_TICK)

    def _angle_deg(self, ticks: int) -> float:
        servo_deg = ticks * registers.DEG_PER_TICK - self._config.zero_deg
        angle_deg = servo_deg / (self._config.direction * self._config.gear_ratio)
        return 0.0 if math.isclose(angle_deg, 0.0, abs_tol=1e-12) else angle_deg
