"""GRBL 1.1h on a light arm: characters in, answers out when they are due.

The main program of the firmware is one long loop that waits in many places: for a line, for room in the planner, for
the end of a dwell. Here it is a generator that yields what it waits for. Real-time characters act at once, whatever
the main program waits for; a reset throws the program away and starts another.
"""

from collections import deque
from collections.abc import Callable, Generator

from firmware_sim.clock import Clock
from firmware_sim.grbl import report
from firmware_sim.grbl.errors import CRITICAL, Alarm, Code, GrblError
from firmware_sim.grbl.gcode import Modes, Move, interpret, interpret_jog, sort_words
from firmware_sim.grbl.homing import SwitchFault
from firmware_sim.grbl.lamp import Lamp
from firmware_sim.grbl.machine import Machine, State
from firmware_sim.grbl.settings import HOMING, REPORT_MASK, Settings, show, store
from firmware_sim.grbl.words import LineFilter, read_number
from firmware_sim.motion import Vector

BAUD = 115_200
RX_BYTES = 128
ALARM_PAUSE_S = 0.5
"""After an ALARM line the firmware is deaf for this long; a reset that comes in it does not count."""
DOOR_RESTORE_S = 4.0
"""After a safety door the spindle gets this long to come up to speed."""
HOME_POSITION: Vector = (0.0, 0.0, 0.0)
"""Where G28 goes: the position that no G28.1 has ever changed."""

RESET, STATUS, RESUME, HOLD, DOOR, JOG_CANCEL = 0x18, ord("?"), ord("~"), ord("!"), 0x84, 0x85

Wait = Callable[[], bool] | float
"""What the main program waits for: a condition, or a time."""
Program = Generator[Wait, None, None]


def _never() -> bool:
    return False


def _at_once() -> bool:
    return True


class GrblController:
    """The controller, the arm that it moves, and the lamp on its spindle output.

    `feed` takes what the host wrote and returns what the firmware has said by now; `feed(b"")` only lets time pass.
    """

    def __init__(self, clock: Clock, settings: Settings, true_position: Vector) -> None:
        self._clock = clock
        self._machine = Machine(settings, true_position, clock())
        self._output = ""
        self._rotation = report.Rotation()
        self._wait: Wait = _at_once
        self._boot()

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

    def position(self, time_s: float) -> Vector:
        """Where the arm truly stands, at any time of the last seconds, in machine coordinates of a homed arm."""
        return self._machine.planner.track.position(time_s)

    def feed(self, content: bytes) -> bytes:
        self._catch_up()
        for character in content:
            self._receive(character)
        said, self._output = self._output, ""
        return said.encode("ascii")

    def due_s(self) -> float | None:
        """When something happens without a character from the host."""
        machine = self._machine
        waits = [machine.planner.due_s(machine.now_s), self._wait if isinstance(self._wait, float) else None]
        return min((wait for wait in waits if wait is not None), default=None)

    def break_switches(self, fault: SwitchFault) -> None:
        """Let all limit switches be stuck or dead, or mend them ("none")."""
        self._machine.switch_fault = fault
        self._catch_up()

    # Time and characters

    def _catch_up(self) -> None:
        """Let everything happen that was due, each thing at its own time."""
        now_s = self._clock()
        while (due_s := self.due_s()) is not None and due_s <= now_s:
            self._step(due_s)
        self._step(now_s)

    def _step(self, now_s: float) -> None:
        self._machine.advance(now_s)
        if self._machine.hits_limit():
            self._raise(Alarm.HARD_LIMIT)
        self._run()

    def _run(self) -> None:
        """Take the main program as far as it goes."""
        while self._may_go():
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
        immediate = {
            RESET: self._reset,
            STATUS: self._ask,
            HOLD: self._machine.hold,
            RESUME: self._resume,
            DOOR: self._open_door,
            JOG_CANCEL: self._machine.cancel_jog,
        }
        if character in immediate:
            immediate[character]()
        elif character < 0x80 and len(self._rx) < RX_BYTES:  # overrides, extended characters: thrown away
            self._rx.append(character)
        self._machine.settle()
        self._run()
        self._report_if_heard()

    # Real-time commands

    def _ask(self) -> None:
        self._report_wanted = True

    def _report_if_heard(self) -> None:
        """Answer `?`, unless the firmware is in one of its deaf loops; it answers once when it comes out of that."""
        if self._report_wanted and not self._deaf:
            self._report_wanted = False
            snapshot = self._machine.snapshot(RX_BYTES - len(self._rx))
            mask = int(self._machine.settings[REPORT_MASK])
            text, self._rotation = report.status(snapshot, mask, self._rotation)
            self._output += text

    def _reset(self) -> None:
        machine = self._machine
        if self._deaf_to_reset:
            return
        if machine.state is State.HOME:
            self._raise(Alarm.HOMING_RESET)
        elif machine.state in (State.RUN, State.JOG) or (machine.is_suspended and machine.is_moving):
            self._raise(Alarm.ABORT_IN_MOTION)
        else:
            self._boot()

    def _resume(self) -> None:
        machine = self._machine
        if machine.is_moving or machine.restoring:
            return
        if machine.state is State.HOLD:
            machine.go_on()
        elif machine.state is State.DOOR:
            self._start(self._restore(self._program, self._wait))

    def _restore(self, program: Program, wait: Wait) -> Program:
        """Bring the spindle back, then go on with what the door interrupted."""
        if self._machine.close_door():
            yield self._machine.now_s + DOOR_RESTORE_S
        self._machine.go_on()
        self._program, self._wait = program, wait
        yield _never

    def _open_door(self) -> None:
        if self._machine.state is State.HOME:
            self._raise(Alarm.HOMING_DOOR)
        elif self._machine.state not in (State.ALARM, State.DOOR):
            self._output += report.CHECK_DOOR
            self._machine.open_door()

    # Alarms and starting anew

    def _raise(self, alarm: Alarm) -> None:
        self._machine.stop_dead()
        self._start(self._alarmed(alarm))
        self._run()

    def _alarmed(self, alarm: Alarm) -> Program:
        self._deaf = self._deaf_to_reset = True
        self._output += f"ALARM:{alarm.value}\r\n"
        yield self._machine.now_s + ALARM_PAUSE_S
        if alarm in CRITICAL:
            self._output += report.RESET_TO_CONTINUE
            self._deaf_to_reset = False
            yield _never  # only a reset leads out
        self._boot()
        yield _never

    def _boot(self) -> None:
        """Start the firmware, at power-up or after a reset; an alarm outlives the reset."""
        self._machine.start_anew()
        self._rx: deque[int] = deque()
        self._line = LineFilter()
        self._modes = Modes()
        self._rotation = report.Rotation()
        self._report_wanted = self._deaf = self._deaf_to_reset = False
        self._output += report.BANNER
        if self._machine.state is State.ALARM:
            self._output += report.UNLOCK_HINT
        self._start(self._main())

    # The main program

    def _main(self) -> Program:
        while True:
            yield lambda: not self._machine.is_suspended and bool(self._rx)
            character = chr(self._rx.popleft())
            if character not in "\r\n":
                self._line.add(character)
                continue
            try:
                yield from self._execute(self._line.finish())
            except GrblError as error:
                self._output += f"error:{error.code.value}\r\n"
            else:
                self._output += "ok\r\n"

    def _execute(self, line: str) -> Program:
        if line.startswith("$"):
            yield from self._execute_command(line)
        elif line and self._machine.state in (State.ALARM, State.JOG):
            raise GrblError(Code.LOCKED)
        elif line:
            yield from self._execute_gcode(line)

    def _execute_gcode(self, text: str) -> Program:
        task, modes = interpret(sort_words(text), self._modes, self._machine.planner.end, HOME_POSITION)
        self._modes = modes
        if task.spindle is not None:
            yield self._is_done
            self._machine.set_spindle(*task.spindle)
        if task.dwell_s is not None:
            yield self._is_done
            yield self._machine.now_s + task.dwell_s
        for move in task.moves:
            if self._machine.is_outside(move.target):
                yield from self._stop_at_soft_limit()
            yield from self._move(move, State.RUN)

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
        self._raise(Alarm.SOFT_LIMIT)
        yield _never

    # `$` commands

    def _execute_command(self, line: str) -> Program:
        if line.startswith("$J"):
            yield from self._jog(line)
        elif line[1:2] in {"$", "G", "X"}:
            self._execute_any_time(line)
        elif line == "$":
            self._output += report.HELP
        elif self._machine.state not in (State.IDLE, State.ALARM):
            raise GrblError(Code.NOT_IDLE)
        elif line == "$H":
            yield from self._go_home()
        else:
            self._execute_at_rest(line)

    def _execute_any_time(self, line: str) -> None:
        if line not in ("$$", "$G", "$X"):
            raise GrblError(Code.INVALID_STATEMENT)
        if line == "$$":
            if self._machine.state in (State.RUN, State.HOLD):
                raise GrblError(Code.NOT_IDLE)
            self._output += show(self._machine.settings)
        elif line == "$G":
            self._output += self._modes.describe()
        elif self._machine.state is State.ALARM:
            self._output += report.UNLOCKED
            self._machine.state = State.IDLE

    def _execute_at_rest(self, line: str) -> None:
        texts = {"$I": report.BUILD_INFO, "$N": report.STARTUP_LINES, "$#": report.parameters(HOME_POSITION)}
        if line in texts:
            self._output += texts[line]
        elif line[1] in "HI#":
            raise GrblError(Code.INVALID_STATEMENT)
        elif line[1] in "CRSN":
            raise GrblError(Code.UNSUPPORTED_COMMAND)
        else:
            self._store_setting(line)

    def _store_setting(self, line: str) -> None:
        number, place = read_number(line, 1)
        if line[place : place + 1] != "=":
            raise GrblError(Code.INVALID_STATEMENT)
        value, place = read_number(line, place + 1)
        if place != len(line):
            raise GrblError(Code.INVALID_STATEMENT)
        store(self._machine.settings, int(number), value)

    def _jog(self, line: str) -> Program:
        if self._machine.state not in (State.IDLE, State.JOG):
            raise GrblError(Code.NOT_IDLE)
        if line[2:3] != "=":
            raise GrblError(Code.INVALID_STATEMENT)
        move = interpret_jog(line[3:], self._modes, self._machine.planner.end)
        if self._machine.is_outside(move.target):
            raise GrblError(Code.TRAVEL_EXCEEDED)
        yield from self._move(move, State.JOG)

    def _go_home(self) -> Program:
        """Run the homing cycle; nothing but a reset or the door is heard meanwhile, and `?` is answered at its end."""
        if not self._machine.settings[HOMING]:
            raise GrblError(Code.SETTING_DISABLED)
        self._deaf = True
        homing = self._machine.start_homing()
        yield homing.ends_s
        if homing.alarm is not None:
            self._raise(homing.alarm)
            yield _never
        self._machine.finish_homing()
        self._deaf = False
        self._report_if_heard()
        self._machine.state = State.IDLE
