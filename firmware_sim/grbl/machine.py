"""The light arm as the firmware drives it: named states, motion, outputs, limit switches."""

from enum import Enum

from firmware_sim.grbl import report
from firmware_sim.grbl.dialect import Dialect
from firmware_sim.grbl.gcode import MM_PER_INCH, Modes, Move
from firmware_sim.grbl.homing import Groups, Homing, SwitchFault, homed_position, plan_homing, pressed, switch_positions
from firmware_sim.grbl.lamp import Lamp, duty
from firmware_sim.grbl.overrides import Overrides
from firmware_sim.grbl.planner import Planner, on_steps, plan_block
from firmware_sim.grbl.settings import (
    HARD_LIMITS,
    HOMING,
    LASER,
    REPORT_INCHES,
    SOFT_LIMITS,
    SPINDLE_MAX,
    SPINDLE_MIN,
    TRAVEL,
    Settings,
    homing_groups,
    of_axes,
)
from firmware_sim.motion import Vector

LOOK_S = 0.005
"""How often limit switches and blocked shafts are looked at while something moves."""


class State(Enum):
    """The names in status reports."""

    IDLE = "Idle"
    RUN = "Run"
    HOLD = "Hold"
    JOG = "Jog"
    HOME = "Home"
    DOOR = "Door"
    ALARM = "Alarm"
    CHECK = "Check"
    SLEEP = "Sleep"


AT_REST = (State.IDLE, State.ALARM, State.CHECK, State.SLEEP)


class Machine:
    """What real-time commands act on. It knows nothing of lines and answers."""

    def __init__(self, settings: Settings, true_position: Vector, now_s: float, dialect: Dialect) -> None:
        self.settings = settings
        self.now_s = now_s
        self.overrides = Overrides()
        self._dialect = dialect
        self.planner = Planner(true_position, now_s, self.overrides, dialect.blocks)
        self.lamp = Lamp(now_s)
        self.switch_fault: SwitchFault = "none"
        self.state = State.ALARM if settings[HOMING] else State.IDLE
        self.output = Modes()
        """The modes whose spindle and coolant are in force."""
        self.homed = False
        self.restoring = False
        """The door is closed again, and the spindle comes up to speed."""
        self.door_open = False
        # The frame does not move when somebody changes $130: the switches stand where they were mounted.
        self._switches = switch_positions(settings)
        self._output_stopped = False
        self._jog_cancelled = False
        self._blocked: dict[int, float] = {}

    @property
    def is_moving(self) -> bool:
        return self.planner.is_moving(self.now_s)

    @property
    def is_suspended(self) -> bool:
        """No line is taken up before a resume."""
        return self.state in (State.HOLD, State.DOOR, State.SLEEP)

    @property
    def state_name(self) -> str:
        """The state as a status report names it."""
        if self.state is State.HOLD:
            return "Hold:1" if self.is_moving else "Hold:0"
        if self.state is State.DOOR:
            at_rest = "Door:1" if self.door_open else "Door:0"
            return "Door:3" if self.restoring else "Door:2" if self.is_moving else at_rest
        return str(self.state.value)

    def due_s(self) -> float | None:
        """When a motion ends, or switches and shafts have to be looked at again."""
        due_s = self.planner.due_s(self.now_s)
        watched = self.settings[HARD_LIMITS] or self._blocked
        return min(due_s, self.now_s + LOOK_S) if due_s is not None and watched else due_s

    def advance(self, now_s: float) -> None:
        self.now_s = now_s
        self.planner.advance(now_s)
        self._hold_back()
        self.settle()

    def settle(self) -> None:
        """Leave the states that end with a motion."""
        if self._jog_cancelled and not self.is_moving:
            self.planner.flush(self.now_s)
            self._jog_cancelled = False
        if self.state in (State.RUN, State.JOG) and self.planner.is_empty:
            self.state = State.IDLE
        if self.settings[LASER]:
            if self.state is State.HOLD and not self.is_moving:
                self._stop_output()
            self._drive_output()  # M4 shines while something moves

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
        self._output_stopped = False
        self._drive_output()
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
        self._stop_output()

    def close_door(self) -> bool:
        """Bring back the spindle that the door has stopped; returns whether there was one."""
        self.restoring = True
        self._output_stopped = False
        self._drive_output()
        return self.output.spindle != Modes().spindle

    def override(self, byte: int) -> bool:
        """Take up an override; returns whether anything changed."""
        changed = self.overrides.take(byte)
        if changed:
            self.planner.replan(self.now_s)
            self._drive_output()
        return changed

    def toggle_output_stop(self) -> None:
        """Stop the spindle during a hold, or start it again."""
        if self.state is State.HOLD and self.output.spindle != Modes().spindle:
            self._output_stopped = not self._output_stopped
            self._drive_output()

    def stop_dead(self) -> None:
        """Go into alarm. If the motors turn, they are stopped at once and the position is lost."""
        if self.is_moving:
            self.planner.kill(self.now_s)
            self.homed = False
        self.state = State.ALARM
        self.start_anew()

    def start_anew(self) -> None:
        """Forget everything planned and switch the outputs off; an alarm stays, and sleep ends in one."""
        self.planner.flush(self.now_s)
        self.overrides.feed = self.overrides.rapid = self.overrides.spindle = 100
        self._output_stopped = False
        self.set_output(Modes())
        self.restoring = self._jog_cancelled = False
        if self.state is not State.ALARM:
            self.state = State.ALARM if self.state is State.SLEEP else State.IDLE

    def lose_power(self) -> None:
        """Stop wherever it is; where that is, nobody knows when the power comes back."""
        self.planner.kill(self.now_s)
        self.start_anew()
        place = self.planner.track.position(self.now_s)
        self.planner.set_position((0.0,) * len(place), self.now_s)
        self.homed = False
        self.state = State.ALARM if self.settings[HOMING] else State.IDLE

    # What lines ask for

    def set_output(self, modes: Modes) -> None:
        self.output = modes
        self._drive_output()

    def add(self, move: Move, state: State) -> None:
        """Queue a move; the arm starts at once if it was idle."""
        block = plan_block(self.planner.end, move, self.settings)
        if block is not None:
            self.planner.add(block, self.now_s)
            if self.state is State.IDLE:
                self.state = state

    def is_outside(self, target: Vector) -> bool:
        """Tell whether soft limits are on and forbid a target; an axis without travel has none."""
        if not self.settings[SOFT_LIMITS] or not (self.homed or self._dialect.limits_unhomed):
            return False
        lengths = of_axes(self.settings, TRAVEL)
        return any(length and not -length <= place <= 0 for place, length in zip(target, lengths, strict=True))

    def start_homing(self, groups: Groups | None) -> Homing:
        self.state = State.HOME
        self._groups = homing_groups(self.settings) if groups is None else groups
        start = self.planner.track.position(self.now_s)
        homing = plan_homing(self.now_s, start, self.settings, self._switches, self.switch_fault, self._groups)
        self.planner.track.follow(homing.pieces)
        return homing

    def finish_homing(self) -> None:
        before = self.planner.position(self.now_s)
        self.planner.set_position(homed_position(self.settings, before, self._groups), self.now_s)
        self.homed = True

    # Mishaps

    def block(self, axis: int, *, blocked: bool) -> None:
        """Let a shaft stand still however the motor pulls, or let it go; the controller does not notice."""
        self._blocked.pop(axis, None)
        if blocked:
            self._blocked[axis] = self.planner.track.position(self.now_s)[axis]

    def slip(self, axis: int, lost: float) -> None:
        """Lose some steps at once."""
        here = self.planner.track.position(self.now_s)
        self.planner.lose_steps(tuple(lost * (place == axis) for place in range(len(here))), self.now_s)

    def _hold_back(self) -> None:
        here = self.planner.track.position(self.now_s)
        for axis, place in self._blocked.items():
            if here[axis] != place:
                self.slip(axis, here[axis] - place)

    # What there is to see

    def pressed(self) -> str:
        """Return the axes whose limit switches read pressed."""
        true_position = self.planner.track.position(self.now_s)
        return pressed(true_position, self.settings, self._switches, self.switch_fault)

    def hits_limit(self) -> bool:
        """Tell whether hard limits are on and a switch is pressed; homing and alarms do not look at them."""
        watched = self.settings[HARD_LIMITS] and self.state not in (State.ALARM, State.HOME, State.SLEEP)
        return bool(watched and self.pressed())

    def snapshot(self, free_bytes: int, offset: Vector) -> report.Snapshot:
        unit = MM_PER_INCH if self.settings[REPORT_INCHES] else 1.0
        position = on_steps(self.planner.position(self.now_s), self.settings)
        return report.Snapshot(
            state=self.state_name,
            position=tuple(value / unit for value in position),
            offset=tuple(value / unit for value in offset),
            free_blocks=self.planner.free_blocks,
            free_bytes=free_bytes,
            feed=self.planner.speed(self.now_s) * 60 / unit,
            speed=self._output_speed(),
            pins=self.pressed() + "D" * self.door_open,
            accessories=self._accessories(),
            overrides=self.overrides.as_tuple(),
            homed=self.homed,
            busy=self.state not in AT_REST,
        )

    def _output_speed(self) -> float:
        """Return the S in force; a laser is dark under G0, and with M4, power by speed, at rest."""
        modes = self.output
        if modes.spindle == Modes().spindle or self._output_stopped:
            return 0.0
        if self.settings[LASER] and (modes.motion != 1 or (modes.spindle == 4 and not self.is_moving)):
            return 0.0
        return modes.speed * self.overrides.spindle / 100

    def _accessories(self) -> str:
        spindle = {3: "S", 4: "C"}.get(self.output.spindle, "")
        return spindle + "F" * self.output.flood + "M" * self.output.mist

    def _stop_output(self) -> None:
        if not self._output_stopped:
            self._output_stopped = True
            self._drive_output()

    def _drive_output(self) -> None:
        speed = self._output_speed()
        power = duty(self.output.spindle, speed, self.settings[SPINDLE_MIN], self.settings[SPINDLE_MAX])
        self.lamp.set(power, self.now_s)
