"""One XL430-W250: registers on one side, a turning shaft on the other."""

import math

from firmware_sim.clock import Clock
from firmware_sim.dynamixel.control_table import (
    ACCELERATION_UNIT_DEG_S2,
    COUNTS_PER_TURN,
    VELOCITY_UNIT_DEG_S,
    Mode,
    Register,
)
from firmware_sim.dynamixel.memory import Memory, Refusal
from firmware_sim.dynamixel.packets import ErrorCode
from firmware_sim.motion import Profile, Track, rest, trapezoid

FASTEST_DEG_S = 61 * 6.0
"""61 rpm: what the gear reaches without load at 12 V."""
HARDEST_DEG_S2 = 7200.0
"""What the motor manages against the table's inertia when no profile holds it back (a round figure)."""
REBOOT_S = 0.25
WATCHDOG_UNIT_S = 0.02
WATCHDOG_TRIPPED = 255
IN_POSITION_COUNTS = 10
SHUTDOWN_CAUSES = 0b0011_1101


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
        self._heard_s = now_s
        self.deaf_until_s = now_s
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
        self.memory.forget_ram()
        self._stalled = False
        self._halt()
        self._power_up()
        self.deaf_until_s = self._clock() + REBOOT_S

    def clear_turns(self) -> None:
        """Bring the position back within one turn, as the Clear instruction does to a resting servo."""
        if self.is_turning():
            raise Refusal(ErrorCode.RESULT_FAIL)
        self._whole_turns = math.floor(self.angle_deg(self._clock()) / 360)
        self.memory[Register.GOAL_POSITION] = self._counts(self.angle_deg(self._clock()))

    def advance(self) -> None:
        """Let the bus watchdog trip if its time is up."""
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

    def stall(self, *, stalled: bool) -> None:
        """Block the shaft, or let it go: then it catches up with its goal."""
        self._stalled = stalled
        now_s = self._clock()
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
        goal = values.get(Register.GOAL_POSITION)
        if goal is not None:
            if self.memory[Register.BUS_WATCHDOG] == WATCHDOG_TRIPPED:
                raise Refusal(ErrorCode.DATA_RANGE)
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
            case Register.TORQUE_ENABLE if value != before:
                self._halt()
                self.memory[Register.GOAL_POSITION] = self._counts(self.angle_deg(now_s))
            case Register.GOAL_POSITION if self.memory[Register.TORQUE_ENABLE]:
                self._go(self._degrees(value))
            case Register.OPERATING_MODE if value != before:
                self._whole_turns = math.floor(self.angle_deg(now_s) / 360)

    def _go(self, goal_deg: float) -> None:
        now_s = self._clock()
        for track in (self._trajectory,) if self._stalled else (self._trajectory, self._shaft):
            at, speed = self._shaft.position(now_s)[0], self._shaft.velocity(now_s)[0]
            track.follow(trapezoid(now_s, at, speed, goal_deg, self._profile()))

    def _profile(self) -> Profile:
        """Zero in a profile register means: as fast as the motor can."""
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
        return round(turned_deg * COUNTS_PER_TURN / 360) + self.memory[Register.HOMING_OFFSET]

    def _degrees(self, counts: int) -> float:
        return (counts - self.memory[Register.HOMING_OFFSET]) * 360 / COUNTS_PER_TURN + 360 * self._whole_turns

    def _refresh(self) -> None:
        """Bring the registers that show the present up to date."""
        now_s = self._clock()
        memory, shaft, trajectory = self.memory, self._shaft, self._trajectory
        under_way = now_s < trajectory.ends_s
        velocity = round(shaft.velocity(now_s)[0] / VELOCITY_UNIT_DEG_S)
        memory[Register.REALTIME_TICK] = int(now_s * 1000) % 32768
        memory[Register.PRESENT_VELOCITY] = velocity
        memory[Register.PRESENT_POSITION] = self._counts(shaft.position(now_s)[0])
        memory[Register.VELOCITY_TRAJECTORY] = round(trajectory.velocity(now_s)[0] / VELOCITY_UNIT_DEG_S)
        memory[Register.POSITION_TRAJECTORY] = self._counts(trajectory.position(now_s)[0])
        memory[Register.MOVING] = int(under_way or abs(velocity) > memory[Register.MOVING_THRESHOLD])
        memory[Register.MOVING_STATUS] = self._moving_status(under_way=under_way)

    def _moving_status(self, *, under_way: bool) -> int:
        """Bit 0: on the goal. Bit 1: profile under way. Bits 4 and 5: a trapezoid, not a plain step."""
        off = abs(self.memory[Register.GOAL_POSITION] - self.memory[Register.PRESENT_POSITION])
        shaped = self.memory[Register.PROFILE_ACCELERATION] and self.memory[Register.PROFILE_VELOCITY]
        return int(off <= IN_POSITION_COUNTS) | (under_way << 1) | (0x30 if shaped else 0)
