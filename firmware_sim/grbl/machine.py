"""The light arm as the firmware drives it: named states, motion, lamp, limit switches."""

from enum import Enum

from firmware_sim.grbl import report
from firmware_sim.grbl.gcode import MM_PER_INCH, Move
from firmware_sim.grbl.homing import Homing, SwitchFault, homed_position, plan_homing, pressed, switch_positions
from firmware_sim.grbl.lamp import Lamp, duty
from firmware_sim.grbl.planner import Planner, on_steps, plan_block
from firmware_sim.grbl.settings import (
    HARD_LIMITS,
    HOMING,
    REPORT_INCHES,
    SOFT_LIMITS,
    SPINDLE_MAX,
    SPINDLE_MIN,
    TRAVEL,
    Settings,
    of_axes,
)
from firmware_sim.motion import Vector

SPINDLE_OFF = 5


class State(Enum):
    """The names in status reports."""

    IDLE = "Idle"
    RUN = "Run"
    HOLD = "Hold"
    JOG = "Jog"
    HOME = "Home"
    DOOR = "Door"
    ALARM = "Alarm"


class Machine:
    """What real-time commands act on. It knows nothing of lines and answers."""

    def __init__(self, settings: Settings, true_position: Vector, now_s: float) -> None:
        self.settings = settings
        self.now_s = now_s
        self.planner = Planner(true_position, now_s)
        self.lamp = Lamp(now_s)
        self.switch_fault: SwitchFault = "none"
        self.state = State.ALARM if settings[HOMING] else State.IDLE
        self.spindle = (SPINDLE_OFF, 0.0)
        self.restoring = False
        """The door is closed again, and the spindle comes up to speed."""
        # The frame does not move when somebody changes $130: the switches stand where they were mounted.
        self._switches = switch_positions(settings)
        self._spindle_before = self.spindle
        self._jog_cancelled = False

    @property
    def is_moving(self) -> bool:
        return self.planner.is_moving(self.now_s)

    @property
    def is_suspended(self) -> bool:
        """No line is taken up before a resume."""
        return self.state in (State.HOLD, State.DOOR)

    @property
    def state_name(self) -> str:
        """The state as a status report names it."""
        if self.state is State.HOLD:
            return "Hold:1" if self.is_moving else "Hold:0"
        if self.state is State.DOOR:
            return "Door:3" if self.restoring else "Door:2" if self.is_moving else "Door:0"
        return str(self.state.value)

    def advance(self, now_s: float) -> None:
        self.now_s = now_s
        self.planner.advance(now_s)
        self.settle()

    def settle(self) -> None:
        """Leave the states that end with a motion."""
        if self._jog_cancelled and not self.is_moving:
            self.planner.flush(self.now_s)
            self._jog_cancelled = False
        if self.state in (State.RUN, State.JOG) and self.planner.is_empty:
            self.state = State.IDLE

    # Real-time commands

    def hold(self) -> None:
        if self.state is State.JOG:
            self.cancel_jog()
        elif self.state in (State.IDLE, State.RUN):
            self.planner.brake(self.now_s)
            self.state = State.HOLD

    def go_on(self) -> None:
        """Resume what a hold or the door has stopped."""
        self.restoring = False
        self.planner.resume(self.now_s)
        self.state = State.IDLE if self.planner.is_empty else State.RUN

    def cancel_jog(self) -> None:
        if self.state is State.JOG:
            self.planner.brake(self.now_s)
            self._jog_cancelled = True

    def open_door(self) -> None:
        """Stop, and switch the lamp off until the resume."""
        if self.state is State.JOG:
            self.cancel_jog()
            return
        self.planner.brake(self.now_s)
        self.state = State.DOOR
        self._spindle_before = self.spindle
        self.set_spindle(SPINDLE_OFF, self.spindle[1])

    def close_door(self) -> bool:
        """Bring back the spindle that the door has stopped; returns whether there was one."""
        self.restoring = True
        self.set_spindle(*self._spindle_before)
        return self.spindle[0] != SPINDLE_OFF

    def stop_dead(self) -> None:
        """Go into alarm. If the motors turn, they are stopped at once and the position is lost."""
        if self.is_moving:
            self.planner.kill(self.now_s)
        self.state = State.ALARM
        self.start_anew()

    def start_anew(self) -> None:
        """Forget everything planned and switch the lamp off; an alarm stays."""
        self.planner.flush(self.now_s)
        self.set_spindle(SPINDLE_OFF, 0.0)
        self.restoring = self._jog_cancelled = False
        if self.state is not State.ALARM:
            self.state = State.IDLE

    # What lines ask for

    def set_spindle(self, mode: int, speed: float) -> None:
        self.spindle = (mode, speed)
        power = duty(mode, speed, self.settings[SPINDLE_MIN], self.settings[SPINDLE_MAX])
        self.lamp.set(power, self.now_s)

    def add(self, move: Move, state: State) -> None:
        """Queue a move; the arm starts at once if it was idle."""
        block = plan_block(self.planner.end, move, self.settings)
        if block is not None:
            self.planner.add(block, self.now_s)
            if self.state is State.IDLE:
                self.state = state

    def is_outside(self, target: Vector) -> bool:
        """Tell whether soft limits are on and forbid a target."""
        lengths = of_axes(self.settings, TRAVEL)
        inside = all(-length <= place <= 0 for place, length in zip(target, lengths, strict=True))
        return bool(self.settings[SOFT_LIMITS]) and not inside

    def start_homing(self) -> Homing:
        self.state = State.HOME
        start = self.planner.track.position(self.now_s)
        homing = plan_homing(self.now_s, start, self.settings, self._switches, self.switch_fault)
        self.planner.track.follow(homing.pieces)
        return homing

    def finish_homing(self) -> None:
        self.planner.set_position(homed_position(self.settings), self.now_s)

    # What there is to see

    def pressed(self) -> str:
        """Return the axes whose limit switches read pressed."""
        true_position = self.planner.track.position(self.now_s)
        return pressed(true_position, self.settings, self._switches, self.switch_fault)

    def hits_limit(self) -> bool:
        """Tell whether hard limits are on and a switch is pressed; homing and alarms do not look at them."""
        watched = self.settings[HARD_LIMITS] and self.state not in (State.ALARM, State.HOME)
        return bool(watched and self.pressed())

    def snapshot(self, free_bytes: int) -> report.Snapshot:
        unit = MM_PER_INCH if self.settings[REPORT_INCHES] else 1.0
        position = on_steps(self.planner.position(self.now_s), self.settings)
        mode, speed = self.spindle
        return report.Snapshot(
            state=self.state_name,
            position=tuple(value / unit for value in position),
            free_blocks=self.planner.free_blocks,
            free_bytes=free_bytes,
            feed=self.planner.speed(self.now_s) * 60 / unit,
            speed=0.0 if mode == SPINDLE_OFF else speed,
            limits=self.pressed(),
            spindle=mode,
            busy=self.state not in (State.IDLE, State.ALARM),
        )
