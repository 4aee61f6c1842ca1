"""The firmware's main program: one line after the other, as a generator that yields what it waits for.

Real-time characters act at once, whatever it waits for; a reset throws it away and starts another.
"""

from collections import deque
from collections.abc import Callable, Generator
from typing import Protocol

from firmware_sim.grbl import report, system
from firmware_sim.grbl.dialect import Dialect
from firmware_sim.grbl.eeprom import Eeprom
from firmware_sim.grbl.errors import Alarm, Code, GrblError
from firmware_sim.grbl.gcode import Frame, Modes, Move, interpret, interpret_jog, sort_words
from firmware_sim.grbl.homing import Groups
from firmware_sim.grbl.machine import Machine, State
from firmware_sim.grbl.settings import AXES, HOMING, LASER
from firmware_sim.grbl.words import LineFilter

Wait = Callable[[], bool] | float
"""What it waits for: a condition, or a time."""
Program = Generator[Wait, None, None]


def never() -> bool:
    return False


class Surroundings(Protocol):
    """What the main program asks of the rest of the firmware."""

    def say(self, text: str) -> None:
        """Send something to the host."""

    def alarm(self, alarm: Alarm) -> None:
        """Stop everything; this program is thrown away."""

    def boot(self) -> None:
        """Start anew; this program is thrown away."""

    def hang(self) -> bool:
        """Do nothing any more, if the dialect does so after a reset; returns whether it does."""

    def offsets_changed(self) -> None:
        """Let the next report have the work offset."""

    def hear_again(self) -> None:
        """Answer a question that came while nobody listened."""


class MainProgram:
    """What goes on from one start of the firmware to the next.

    Attributes
    ----------
    rx : characters that wait to be read
    modes : of the G-code so far
    shift : of G92, which no EEPROM keeps
    dwells_from_s : since when a dwell counts its time; None without one
    is_deaf : whether a question must wait
    """

    def __init__(self, machine: Machine, eeprom: Eeprom, dialect: Dialect, firmware: Surroundings) -> None:
        self._machine, self._eeprom, self._dialect, self._firmware = machine, eeprom, dialect, firmware
        self._axes = AXES[: len(eeprom.zero)]
        self._line = LineFilter()
        self.rx: deque[int] = deque()
        self.modes = Modes()
        self.shift = eeprom.zero
        self.dwells_from_s: float | None = None
        self.is_deaf = False

    @property
    def frame(self) -> Frame:
        """What coordinates count from."""
        return Frame(self._eeprom.places, self.shift)

    def run(self) -> Program:
        """Run start-up lines, then lines as they come."""
        yield from self._run_startup_lines()
        while True:
            yield lambda: not self._machine.is_suspended and bool(self.rx)
            character = chr(self.rx.popleft())
            if character not in "\r\n":
                self._line.add(character)
                continue
            try:
                yield from self._execute(self._line.finish())
            except GrblError as error:
                self._firmware.say(f"error:{error.code.value}\r\n")
            else:
                self._firmware.say("ok\r\n")

    def _run_startup_lines(self) -> Program:
        """Run what $N0 and $N1 say, unless an alarm locks."""
        for line in self._eeprom.startup_lines:
            if not line or self._machine.state is State.ALARM:
                continue
            try:
                yield from self._execute_gcode(line)
            except GrblError as error:
                self._firmware.say(f">{line}:error:{error.code.value}\r\n")
            else:
                self._firmware.say(f">{line}:ok\r\n")

    def _execute(self, line: str) -> Program:
        if line.startswith("$"):
            yield from self._execute_command(line)
        elif line and self._machine.state in (State.ALARM, State.JOG):
            raise GrblError(Code.LOCKED)
        elif line:
            yield from self._execute_gcode(line)

    def _execute_gcode(self, text: str) -> Program:
        line = sort_words(text, self._axes)
        task, modes = interpret(line, self.modes, self._machine.planner.end, self.frame)
        self.modes = modes
        if self._machine.state is State.CHECK:
            return
        if task.output_changes:
            # In laser mode M3 changes its power on the way; all else waits for the end of motion.
            if not (self._machine.settings[LASER] and task.moves):
                yield self._is_done
            self._machine.set_output(modes)
        if task.dwell_s is not None:
            yield from self._dwell(task.dwell_s)
        if task.stores or task.shift is not None:
            yield self._is_done
            self._eeprom.places.update(task.stores)
            self.shift = self.shift if task.shift is None else task.shift
            self._firmware.offsets_changed()
        for move in task.moves:
            if self._machine.is_outside(move.target):
                yield from self._stop_at_soft_limit()
            yield from self._move(move, State.RUN)
        if task.flow is not None:
            yield from self._control_flow(task.flow)

    def _dwell(self, seconds: float) -> Program:
        """Wait for the planner and then for the time; a hold stops the waiting, not the clock."""
        yield self._is_done
        self.dwells_from_s = self._machine.now_s
        yield self._machine.now_s + seconds
        yield lambda: not self._machine.is_suspended
        self.dwells_from_s = None

    def _control_flow(self, code: int) -> Program:
        yield self._is_done
        if code in (0, 1):
            self._machine.hold()
            yield lambda: not self._machine.is_suspended
            return
        self.modes = self.modes.at_program_end()
        self._machine.set_output(self.modes)
        self._firmware.say(report.PROGRAM_END)

    def _is_done(self) -> bool:
        """Tell whether all that was planned has been done: what a synchronising command waits for."""
        return self._machine.planner.is_empty and not self._machine.is_suspended

    def _move(self, move: Move, state: State) -> Program:
        yield lambda: self._machine.planner.free_blocks > 0
        self._machine.add(move, state)

    def _stop_at_soft_limit(self) -> Program:
        """Come to rest on the path first, so that the position is kept."""
        self._machine.planner.brake(self._machine.now_s)
        yield lambda: not self._machine.is_moving
        self._firmware.alarm(Alarm.SOFT_LIMIT)
        yield never

    # `$` commands

    def _execute_command(self, line: str) -> Program:
        machine = self._machine
        if line.startswith("$J"):
            yield from self._jog(line)
        elif line[1:2] in {"$", "G", "X"}:
            self._firmware.say(system.answer_any_time(line, machine, self.modes))
        elif line == "$":
            self._firmware.say(report.HELP)
        elif line == "$C":
            yield from self._toggle_check_mode()
        elif machine.state not in (State.IDLE, State.ALARM):
            raise GrblError(Code.NOT_IDLE)
        elif line == "$H" or (line[:2] == "$H" and self._dialect.homes_single_axes and line[2:] in self._axes):
            yield from self._go_home(line[2:])
        elif line == "$SLP":
            machine.state = State.SLEEP
            machine.set_output(Modes())
            self._firmware.say(report.SLEEPING)
        elif line.startswith("$RST"):
            system.restore(line, self._eeprom)
            self._firmware.say(report.RESTORING)
            yield from self._restart()
        else:
            if line[1:2].isdigit() and self._firmware.hang():
                yield never
            self._firmware.say(system.answer_at_rest(line, self._eeprom, machine.state, self._dialect, self.shift))

    def _toggle_check_mode(self) -> Program:
        """Read lines and do nothing of what they say, or leave off doing so, which is a reset."""
        if self._machine.state is State.CHECK:
            self._firmware.say(report.DISABLED)
            yield from self._restart()
        if self._machine.state is not State.IDLE:
            raise GrblError(Code.NOT_IDLE)
        self._machine.state = State.CHECK
        self._firmware.say(report.ENABLED)

    def _restart(self) -> Program:
        """Say ok, and reset."""
        self._firmware.say("ok\r\n")
        self._firmware.boot()
        yield never

    def _jog(self, line: str) -> Program:
        if self._machine.state not in (State.IDLE, State.JOG):
            raise GrblError(Code.NOT_IDLE)
        if line[2:3] != "=":
            raise GrblError(Code.INVALID_STATEMENT)
        words = sort_words(line[3:], self._axes)
        move = interpret_jog(words, self.modes, self._machine.planner.end, self.frame)
        if self._machine.is_outside(move.target):
            raise GrblError(Code.TRAVEL_EXCEEDED)
        yield from self._move(move, State.JOG)

    def _go_home(self, axis: str) -> Program:
        """Run the homing cycle; nothing but a reset or the door is heard meanwhile, and `?` is answered at its end."""
        if not self._machine.settings[HOMING]:
            raise GrblError(Code.SETTING_DISABLED)
        groups: Groups | None = [(self._axes.index(axis),)] if axis else None
        self.is_deaf = True
        homing = self._machine.start_homing(groups)
        yield homing.ends_s
        if homing.alarm is not None:
            self._firmware.alarm(homing.alarm)
            yield never
        self._machine.finish_homing()
        self.is_deaf = False
        self._firmware.hear_again()
        self._machine.state = State.IDLE
