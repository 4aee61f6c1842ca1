"""One XL430-W250: registers on one side, a turning shaft on the other."""

import math

from firmware_sim.clock import Clock
from firmware_sim.dynamixel.control_table import (
    ACCELERATION_UNIT_DEG_S2,
    COUNTS_PER_TURN,
    VELOCITY_UNIT_DEG_S,
    DriveMode,
    Mode,
    Register,
    Startup,
)
from firmware_sim.dynamixel.memory import Memory, Refusal
from firmware_sim.dynamixel.packets import ErrorCode
from firmware_sim.motion import Piece, Profile, Track, rest, trapezoid

FASTEST_DEG_S = 61 * 6.0
"""61 rpm: what the gear reaches without load at 12 V."""
HARDEST_DEG_S2 = 7200.0
"""What the motor manages against the table's inertia when no profile holds it back (a round figure)."""
REBOOT_S = 0.25
WATCHDOG_UNIT_S = 0.02
WATCHDOG_TRIPPED = 255
IN_POSITION_COUNTS = 10
SHUTDOWN_CAUSES = 0b0011_1101
INPUT_VOLTAGE, OVERHEATING, OVERLOAD = 1 << 0, 1 << 2, 1 << 5
GOALS = frozenset({Register.GOAL_PWM, Register.GOAL_VELOCITY, Register.GOAL_POSITION})
FULL_LOAD = 1000
RING = (1.0, -0.5, 0.25, 0.0)
"""Where the shaft swings after it has passed its goal, as shares of the overshoot."""
RESTORED = (
    Register.PROFILE_ACCELERATION,
    Register.PROFILE_VELOCITY,
    Register.POSITION_P_GAIN,
    Register.POSITION_I_GAIN,
    Register.POSITION_D_GAIN,
)


class Servo:
    """The state of one servo. `advance` brings it to the present; the bus calls that before anything else."""

    def __init__(self, clock: Clock, servo_id: int, start_deg: float) -> None:
        self._clock = clock
        self.memory = Memory()
        self.memory[Register.ID] = servo_id
        now_s = clock()
        self._shaft = Track((start_deg,), now_s)
        self._trajectory = Track((start_deg,), now_s)
        self._whole_turns = 0
        self._stalled = False
        self._stalled_s = now_s
        self._heard_s = now_s
        self._before_deg = start_deg
        self.deaf_until_s = now_s
        self.stall_at_deg: float | None = None
        self.overload_after_s: float | None = None
        self.overshoot_deg = 0.0
        self._power_up()

    @property
    def servo_id(self) -> int:
        return self.memory[Register.ID]

    def angle_deg(self, time_s: float) -> float:
        """Angle of the shaft itself, never rounded to encoder counts, at any time of the last seconds."""
        return self._shaft.position(time_s)[0]

    def is_turning(self) -> bool:
        return not self._shaft.is_resting(self._clock())

    # What the host asks for

    def read(self, address: int, length: int) -> bytes:
        self._refresh()
        return self.memory.read(address, length)

    def write(self, address: int, content: bytes) -> None:
        """Store registers and do what they stand for; a refused write stores nothing.

        Raises
        ------
        Refusal
            The error code to answer with.
        """
        values = self.memory.parse_write(address, content)
        self._refuse_beyond_limits(values)
        for register, value in values.items():
            self._store(register, value)

    def heard(self) -> None:
        """Start the bus watchdog anew, since an instruction came by."""
        self._heard_s = self._clock()

    def reboot(self) -> None:
        startup = self.memory[Register.STARTUP_CONFIGURATION]
        kept = {register: self.memory[register] for register in RESTORED if startup & Startup.RAM_RESTORE}
        self.memory.forget_ram()
        for register, value in kept.items():
            self.memory[register] = value
        self._halt()
        self._power_up()
        self.memory[Register.TORQUE_ENABLE] = int(bool(startup & Startup.TORQUE_ON))
        self.deaf_until_s = self._clock() + REBOOT_S

    def factory_reset(self, *keep: Register) -> None:
        self.memory.factory_reset(*keep)
        self.reboot()

    def clear_turns(self) -> None:
        """Bring the position back within one turn, as the Clear instruction does to a resting servo."""
        if self.is_turning():
            raise Refusal(ErrorCode.RESULT_FAIL)
        self._whole_turns = math.floor(self.angle_deg(self._clock()) / 360)
        self.memory[Register.GOAL_POSITION] = self._counts(self.angle_deg(self._clock()))

    def advance(self) -> None:
        """Let happen what time brings: the bus watchdog trips, the shaft meets its block, the motor is overloaded."""
        now_s = self._clock()
        here_deg, place_deg, before_deg = self.angle_deg(now_s), self.stall_at_deg, self._before_deg
        if place_deg is not None and here_deg != before_deg and (place_deg - before_deg) * (place_deg - here_deg) <= 0:
            self.stall(stalled=True)
        self._before_deg = here_deg
        if self._pushes() and self.overload_after_s and now_s - self._stalled_s > self.overload_after_s:
            self.fail_hardware(OVERLOAD)
        limit = self.memory[Register.BUS_WATCHDOG]
        if not self.memory[Register.TORQUE_ENABLE] or limit in (0, WATCHDOG_TRIPPED):
            return
        if self._clock() - self._heard_s > limit * WATCHDOG_UNIT_S:
            self.memory[Register.BUS_WATCHDOG] = WATCHDOG_TRIPPED
            self._halt()

    # What goes wrong with the hardware

    def fail_hardware(self, bits: int) -> None:
        """Raise bits of the hardware error status; those that the shutdown mask names take the torque away."""
        self.memory[Register.HARDWARE_ERROR_STATUS] |= bits & SHUTDOWN_CAUSES
        if bits & self.memory[Register.SHUTDOWN]:
            self.memory[Register.TORQUE_ENABLE] = 0
            self._halt()

    def brown_out(self, turned_deg: float = 0.0) -> None:
        """Start anew after a sag of the supply; without torque, the load may turn the shaft meanwhile."""
        now_s = self._clock()
        self._shaft.follow([rest(now_s, (self.angle_deg(now_s) + turned_deg,))])
        self.reboot()

    def feel(self, *, volts: float | None = None, deg_c: int | None = None) -> None:
        """Change supply or temperature; beyond the limits they are hardware errors."""
        memory = self.memory
        if volts is not None:
            memory[Register.PRESENT_INPUT_VOLTAGE] = round(10 * volts)
            low, high = memory[Register.MIN_VOLTAGE_LIMIT], memory[Register.MAX_VOLTAGE_LIMIT]
            if not low <= round(10 * volts) <= high:
                self.fail_hardware(INPUT_VOLTAGE)
        if deg_c is not None:
            memory[Register.PRESENT_TEMPERATURE] = deg_c
            if deg_c > memory[Register.TEMPERATURE_LIMIT]:
                self.fail_hardware(OVERHEATING)

    def stall(self, *, stalled: bool) -> None:
        """Block the shaft, or let it go: then it catches up with its goal."""
        now_s = self._clock()
        if stalled and not self._stalled:
            self._stalled_s = now_s
        self._stalled = stalled
        if stalled:
            self._shaft.halt(now_s)
        elif self.memory[Register.TORQUE_ENABLE]:
            self._go(self._degrees(self.memory[Register.GOAL_POSITION]))

    # Inside

    def _power_up(self) -> None:
        angle_deg = self.angle_deg(self._clock())
        self._whole_turns = math.floor(angle_deg / 360)
        self.memory[Register.GOAL_POSITION] = self._counts(angle_deg)

    def _refuse_beyond_limits(self, values: dict[Register, int]) -> None:
        if self.memory[Register.BUS_WATCHDOG] == WATCHDOG_TRIPPED and (
            GOALS & values.keys() or values.get(Register.BUS_WATCHDOG)
        ):
            raise Refusal(ErrorCode.DATA_RANGE)
        goal = values.get(Register.GOAL_POSITION)
        if goal is not None:
            low, high = self.memory[Register.MIN_POSITION_LIMIT], self.memory[Register.MAX_POSITION_LIMIT]
            if self.memory[Register.OPERATING_MODE] == Mode.POSITION and not low <= goal <= high:
                raise Refusal(ErrorCode.DATA_LIMIT)
        shut_down = self.memory[Register.HARDWARE_ERROR_STATUS] & self.memory[Register.SHUTDOWN]
        if values.get(Register.TORQUE_ENABLE) and shut_down:
            raise Refusal(ErrorCode.RESULT_FAIL)

    def _store(self, register: Register, value: int) -> None:
        before = self.memory[register]
        self.memory[register] = value
        now_s = self._clock()
        match register:
            case Register.GOAL_POSITION if self.memory[Register.DRIVE_MODE] & DriveMode.TORQUE_ON_BY_GOAL:
                self.memory[Register.TORQUE_ENABLE] = 1
                self._go(self._degrees(value))
            case Register.TORQUE_ENABLE if value != before:
                self._halt()
                self.memory[Register.GOAL_POSITION] = self._counts(self.angle_deg(now_s))
            case Register.GOAL_POSITION if self.memory[Register.TORQUE_ENABLE]:
                self._go(self._degrees(value))
            case Register.OPERATING_MODE if value != before:
                self._whole_turns = math.floor(self.angle_deg(now_s) / 360)

    def _go(self, goal_deg: float) -> None:
        now_s = self._clock()
        at, speed = self._shaft.position(now_s)[0], self._shaft.velocity(now_s)[0]
        pieces = trapezoid(now_s, at, speed, goal_deg, self._profile(goal_deg - at))
        self._trajectory.follow(pieces)
        if not self._stalled:
            self._shaft.follow(self._ringing(pieces))

    def _ringing(self, pieces: list[Piece]) -> list[Piece]:
        """Let the shaft swing about its goal before it rests there."""
        goal_deg = pieces[-1].position[0]
        for share in RING if self.overshoot_deg else ():
            end = pieces[-1]
            swing_to = goal_deg + share * self.overshoot_deg
            pieces = [
                *pieces[:-1],
                *trapezoid(end.start_s, end.position[0], 0.0, swing_to, Profile(FASTEST_DEG_S, HARDEST_DEG_S2)),
            ]
        return pieces

    def _pushes(self) -> bool:
        """Tell whether the motor pushes in vain."""
        if not (self._stalled and self.memory[Register.TORQUE_ENABLE]):
            return False
        here_deg, goal_deg = self.angle_deg(self._clock()), self._degrees(self.memory[Register.GOAL_POSITION])
        return abs(goal_deg - here_deg) > 360 / COUNTS_PER_TURN

    def _profile(self, way_deg: float) -> Profile:
        """Zero in a profile register means: as fast as the motor can. By drive mode both may be times instead."""
        if self.memory[Register.DRIVE_MODE] & DriveMode.TIME_BASED_PROFILE:
            whole_s = self.memory[Register.PROFILE_VELOCITY] / 1000
            rise_s = min(self.memory[Register.PROFILE_ACCELERATION] / 1000, whole_s / 2)
            speed = abs(way_deg) / (whole_s - rise_s) if whole_s else math.inf
            return Profile(
                min(speed, FASTEST_DEG_S) or FASTEST_DEG_S, min(speed / rise_s if rise_s else math.inf, HARDEST_DEG_S2)
            )
        asked_deg_s = self.memory[Register.PROFILE_VELOCITY] * VELOCITY_UNIT_DEG_S or math.inf
        asked_deg_s2 = self.memory[Register.PROFILE_ACCELERATION] * ACCELERATION_UNIT_DEG_S2 or math.inf
        limit_deg_s = self.memory[Register.VELOCITY_LIMIT] * VELOCITY_UNIT_DEG_S
        return Profile(min(asked_deg_s, limit_deg_s, FASTEST_DEG_S), min(asked_deg_s2, HARDEST_DEG_S2))

    def _halt(self) -> None:
        now_s = self._clock()
        self._shaft.halt(now_s)
        self._trajectory.follow([rest(now_s, self._shaft.position(now_s))])

    def _counts(self, angle_deg: float) -> int:
        turned_deg = angle_deg - 360 * self._whole_turns
        return round(self._sense * turned_deg * COUNTS_PER_TURN / 360) + self.memory[Register.HOMING_OFFSET]

    def _degrees(self, counts: int) -> float:
        turned = self._sense * (counts - self.memory[Register.HOMING_OFFSET])
        return turned * 360 / COUNTS_PER_TURN + 360 * self._whole_turns

    @property
    def _sense(self) -> int:
        return -1 if self.memory[Register.DRIVE_MODE] & DriveMode.REVERSE else 1

    def _refresh(self) -> None:
        """Bring the registers that show the present up to date."""
        now_s = self._clock()
        memory, shaft, trajectory = self.memory, self._shaft, self._trajectory
        under_way = now_s < trajectory.ends_s
        velocity = round(self._sense * shaft.velocity(now_s)[0] / VELOCITY_UNIT_DEG_S)
        memory[Register.REALTIME_TICK] = int(now_s * 1000) % 32768
        memory[Register.PRESENT_VELOCITY] = velocity
        memory[Register.PRESENT_POSITION] = self._counts(shaft.position(now_s)[0])
        memory[Register.PRESENT_LOAD] = FULL_LOAD if self._pushes() else 0
        memory[Register.VELOCITY_TRAJECTORY] = round(self._sense * trajectory.velocity(now_s)[0] / VELOCITY_UNIT_DEG_S)
        memory[Register.POSITION_TRAJECTORY] = self._counts(trajectory.position(now_s)[0])
        memory[Register.MOVING] = int(under_way or abs(velocity) > memory[Register.MOVING_THRESHOLD])
        memory[Register.MOVING_STATUS] = self._moving_status(under_way=under_way)

    def _moving_status(self, *, under_way: bool) -> int:
        """Bit 0: on the goal. Bit 1: profile under way. Bits 4 and 5: a trapezoid, not a plain step."""
        off = abs(self.memory[Register.GOAL_POSITION] - self.memory[Register.PRESENT_POSITION])
        shaped = self.memory[Register.PROFILE_ACCELERATION] and self.memory[Register.PROFILE_VELOCITY]
        return int(off <= IN_POSITION_COUNTS) | (under_way << 1) | (0x30 if shaped else 0)
