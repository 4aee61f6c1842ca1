"""GRBL 1.1h or grblHAL on a light arm or a turntable: characters in, answers out when they are due.

Here are time, real-time characters, alarms and resets; lines are read by the main program, a generator that yields what
it waits for.
"""

import math
from collections.abc import Callable
from functools import partial

from firmware_sim.clock import Clock
from firmware_sim.grbl import overrides, report
from firmware_sim.grbl.dialect import GRBL, Dialect
from firmware_sim.grbl.eeprom import Eeprom
from firmware_sim.grbl.errors import CRITICAL, Alarm
from firmware_sim.grbl.homing import SwitchFault
from firmware_sim.grbl.lamp import Lamp
from firmware_sim.grbl.machine import Machine, State
from firmware_sim.grbl.program import MainProgram, Program, Wait, never
from firmware_sim.grbl.settings import AXES, REPORT_MASK, Settings
from firmware_sim.motion import Vector

BAUD = 115_200
ALARM_PAUSE_S = 0.5
"""After an ALARM line the firmware is deaf for this long; a reset that comes in it does not count."""
DOOR_RESTORE_S = 4.0
"""After a safety door the spindle gets this long to come up to speed."""
DWELL_STEP_S = 0.05
"""In a dwell real-time characters are looked at in steps of this."""

RESET, STATUS, RESUME, HOLD, DOOR, JOG_CANCEL = 0x18, ord("?"), ord("~"), ord("!"), 0x84, 0x85


def _at_once() -> bool:
    return True


class GrblController:
    """The controller, what it moves, and the lamp on its spindle output.

    `feed` takes what the host wrote and returns what the firmware has said by now; `feed(b"")` only lets time pass.
    """

    def __init__(self, clock: Clock, settings: Settings, true_position: Vector, dialect: Dialect = GRBL) -> None:
        self._clock = clock
        self._dialect = dialect
        self._eeprom = Eeprom(settings)
        self._axes = AXES[: len(true_position)]
        self._machine = Machine(settings, true_position, clock(), dialect)
        self._output = ""
        self._rotation = report.Rotation()
        self._wait: Wait = _at_once
        self._back_s: float | None = None
        self._hung = self._was_reset = False
        self._report_s: float | None = None
        self.boot()

    # What the server asks for

    @property
    def baud(self) -> int:
        return BAUD

    @property
    def lamp(self) -> Lamp:
        return self._machine.lamp

    @property
    def state(self) -> str:
        """The state as a status report names it."""
        return self._machine.state_name

    @property
    def is_moving(self) -> bool:
        return self._machine.is_moving

    def position(self, time_s: float) -> Vector:
        """Where everything truly stands, at any time of the last seconds, in machine coordinates of a homed arm."""
        return self._machine.planner.track.position(time_s)

    def feed(self, content: bytes) -> bytes:
        self._catch_up()
        for character in content:
            self._receive(character)
        said, self._output = self._output, ""
        return said.encode("ascii")

    def due_s(self) -> float | None:
        """When something happens without a character from the host."""
        program_s = self._wait if isinstance(self._wait, float) and not self._hung else None
        waits = [self._machine.due_s(), program_s, self._back_s, self._report_s]
        return min((wait for wait in waits if wait is not None), default=None)

    # Mishaps

    def break_switches(self, fault: SwitchFault) -> None:
        """Let all limit switches be stuck or dead, or mend them ("none")."""
        self._machine.switch_fault = fault
        self._catch_up()

    def block_shaft(self, axis: str, *, blocked: bool) -> None:
        """Let an axis stand still however its motor pulls, or let it go."""
        self._catch_up()
        self._machine.block(self._axes.index(axis), blocked=blocked)

    def lose_steps(self, axis: str, lost: float) -> None:
        """Let an axis stay behind its count."""
        self._catch_up()
        self._machine.slip(self._axes.index(axis), lost)
        self._catch_up()

    def set_door(self, *, is_open: bool) -> None:
        """Open the safety door, or close it; after that somebody has to resume."""
        self._catch_up()
        self._machine.door_open = is_open
        if is_open:
            self._open_door()
            self._run()

    def lose_power(self, seconds: float) -> None:
        """Fall silent, and start anew after a while; only the EEPROM remembers."""
        self._catch_up()
        self._machine.lose_power()
        self._start(self._unpowered())
        self._output = ""
        self._main.rx.clear()
        self._report_s = None
        self._back_s = self._machine.now_s + seconds

    def mend(self) -> None:
        """Mend switches, shafts and lamp, and close the door."""
        self.lamp.is_dead = False
        self._catch_up()
        for axis in self._axes:
            self.block_shaft(axis, blocked=False)
        self.break_switches("none")
        self.set_door(is_open=False)

    # Time and characters

    def _catch_up(self) -> None:
        """Let everything happen that was due, each thing at its own time."""
        now_s = self._clock()
        while (due_s := self.due_s()) is not None and due_s <= now_s:
            self._step(due_s)
        self._step(now_s)

    def _step(self, now_s: float) -> None:
        self._machine.advance(now_s)
        if self._back_s is not None:
            if now_s < self._back_s:
                return
            self._back_s = None
            self._hung = self._was_reset = False
            self.boot()
        if self._machine.hits_limit():
            self.alarm(Alarm.HARD_LIMIT)
        self._run()
        if self._report_s is not None and self._report_s <= now_s:
            self._report_if_heard()

    def _run(self) -> None:
        """Take the main program as far as it goes."""
        while not self._hung and self._may_go():
            program = self._program
            wait = next(program)
            if program is self._program:  # a reset within may have replaced it
                self._wait = wait

    def _may_go(self) -> bool:
        return self._wait <= self._machine.now_s if isinstance(self._wait, float) else self._wait()

    def _start(self, program: Program) -> None:
        self._program: Program = program
        self._wait = _at_once

    def _receive(self, character: int) -> None:
        if self._back_s is not None or self._hung:
            return
        immediate: dict[int, Callable[[], None]] = {
            RESET: self._reset,
            STATUS: self._ask,
            HOLD: self._machine.hold,
            RESUME: self._resume,
            DOOR: self._open_door,
            JOG_CANCEL: self._machine.cancel_jog,
            overrides.SPINDLE_STOP: self._machine.toggle_output_stop,
            overrides.FLOOD: partial(self._toggle_coolant, "flood"),
            overrides.MIST: partial(self._toggle_coolant, "mist"),
        }
        if character in immediate:
            immediate[character]()
        elif character >= 0x80:
            if self._machine.override(character):
                self._rotation = report.Rotation(max(self._rotation.offsets, 1), 0)
        elif len(self._main.rx) < self._dialect.rx_bytes:
            self._main.rx.append(character)
        self._machine.settle()
        self._run()
        if self._report_s is not None and self._report_s <= self._machine.now_s:
            self._report_if_heard()

    # Real-time commands

    def _ask(self) -> None:
        now_s = self._machine.now_s
        self._report_s = now_s
        step_s = DWELL_STEP_S if self._main.dwells_from_s is not None else self._dialect.frame_s
        if step_s:
            start_s = self._main.dwells_from_s or 0.0
            self._report_s = start_s + math.ceil((now_s - start_s) / step_s) * step_s

    def _report_if_heard(self) -> None:
        """Answer `?`, unless the firmware is in one of its deaf loops; it answers once when it comes out of that."""
        if self._main.is_deaf:
            self._report_s = None
            self._report_owed = True
            return
        self._report_s, self._report_owed = None, False
        offset = self._main.frame.offset(self._main.modes)
        snapshot = self._machine.snapshot(self._dialect.rx_bytes - len(self._main.rx), offset)
        mask = int(self._machine.settings[REPORT_MASK])
        text, self._rotation = report.status(snapshot, mask, self._rotation, self._dialect)
        self._output += text

    def _reset(self) -> None:
        machine = self._machine
        if self._deaf_to_reset:
            return
        self._was_reset = True
        if machine.state is State.HOME:
            self.alarm(Alarm.HOMING_RESET)
        elif machine.state in (State.RUN, State.JOG) or (machine.is_suspended and machine.is_moving):
            self.alarm(Alarm.ABORT_IN_MOTION)
        else:
            self.boot()

    def _resume(self) -> None:
        machine = self._machine
        if machine.is_moving or machine.restoring or machine.door_open:
            return
        if machine.state is State.HOLD:
            machine.go_on()
        elif machine.state is State.DOOR:
            self._start(self._restore(self._program, self._wait, self._main.dwells_from_s))

    def _restore(self, program: Program, wait: Wait, dwells_from_s: float | None) -> Program:
        """Bring the spindle back, then go on with what the door interrupted."""
        if self._machine.close_door():
            yield self._machine.now_s + DOOR_RESTORE_S
        self._machine.go_on()
        self._program, self._wait, self._main.dwells_from_s = program, wait, dwells_from_s
        yield never

    def _open_door(self) -> None:
        if self._machine.state is State.HOME:
            self.alarm(Alarm.HOMING_DOOR)
        elif self._machine.state not in (State.ALARM, State.DOOR, State.SLEEP):
            self._output += report.CHECK_DOOR
            self._machine.open_door()

    def _toggle_coolant(self, name: str) -> None:
        if self._machine.state in (State.IDLE, State.RUN, State.HOLD):
            modes = self._main.modes
            setattr(modes, name, not getattr(modes, name))
            self._machine.set_output(modes)

    # Alarms and starting anew

    def alarm(self, alarm: Alarm) -> None:
        if alarm in (Alarm.HOMING_RESET, Alarm.HOMING_DOOR, Alarm.HOMING_PULL_OFF, Alarm.HOMING_APPROACH):
            self._machine.homed = False
        self._machine.stop_dead()
        self._start(self._alarmed(alarm))
        self._run()

    def _alarmed(self, alarm: Alarm) -> Program:
        self._main.is_deaf = self._deaf_to_reset = True
        self._output += f"ALARM:{alarm.value}\r\n"
        yield self._machine.now_s + ALARM_PAUSE_S
        if alarm in CRITICAL:
            self._output += report.RESET_TO_CONTINUE
            self._deaf_to_reset = False
            yield never  # only a reset leads out
        self.boot()
        yield never

    def say(self, text: str) -> None:
        self._output += text

    def hang(self) -> bool:
        self._hung = self._dialect.hangs_after_reset and self._was_reset
        return self._hung

    def offsets_changed(self) -> None:
        self._rotation = report.Rotation(0, self._rotation.overrides)

    def hear_again(self) -> None:
        if self._report_owed:
            self._report_if_heard()

    def _unpowered(self) -> Program:
        yield never

    def boot(self) -> None:
        """Start the firmware, at power-up or after a reset; an alarm outlives the reset."""
        self._machine.start_anew()
        self._main = MainProgram(self._machine, self._eeprom, self._dialect, self)
        self._rotation = report.Rotation()
        self._report_s = None
        self._report_owed = self._deaf_to_reset = False
        self._output += self._dialect.banner
        if self._machine.state is State.ALARM:
            self._output += report.UNLOCK_HINT
        self._start(self._main.run())
