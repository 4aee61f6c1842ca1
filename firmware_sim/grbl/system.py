"""The `$` commands that neither move anything nor wait."""

from firmware_sim.grbl import report
from firmware_sim.grbl.dialect import Dialect
from firmware_sim.grbl.eeprom import Eeprom
from firmware_sim.grbl.errors import Code, GrblError
from firmware_sim.grbl.gcode import Modes, sort_words
from firmware_sim.grbl.machine import Machine, State
from firmware_sim.grbl.settings import AXES, show, store
from firmware_sim.grbl.words import read_number
from firmware_sim.motion import Vector


def answer_any_time(line: str, machine: Machine, modes: Modes) -> str:
    """Obey `$$`, `$G` or `$X`, and return what is said before the `ok`."""
    if line == "$$":
        if machine.state in (State.RUN, State.HOLD):
            raise GrblError(Code.NOT_IDLE)
        return show(machine.settings)
    if line == "$G":
        return modes.describe()
    if line != "$X":
        raise GrblError(Code.INVALID_STATEMENT)
    if machine.state is not State.ALARM:
        return ""
    if machine.door_open:
        raise GrblError(Code.CHECK_DOOR)
    machine.state = State.IDLE
    return report.UNLOCKED


def answer_at_rest(line: str, eeprom: Eeprom, state: State, dialect: Dialect, shift: Vector) -> str:
    """Obey a command that wants an idle or locked machine, and return what is said before the `ok`."""
    if line == "$I":
        return dialect.build.format(info=eeprom.build_info)
    if line == "$#":
        return report.parameters(eeprom, shift)
    if line == "$N":
        return "".join(f"$N{number}={text}\r\n" for number, text in enumerate(eeprom.startup_lines))
    if line.startswith("$I="):
        eeprom.build_info = line[3:]
    elif line.startswith("$N"):
        _store_startup_line(line, eeprom, state)
    elif line[1] in "I#H":
        raise GrblError(Code.INVALID_STATEMENT)
    else:
        number, value = setting_of(line)
        store(eeprom.settings, number, value)
    return ""


def setting_of(line: str) -> tuple[int, float]:
    """Take `$n=v` apart."""
    number, place = read_number(line, 1)
    if line[place : place + 1] != "=":
        raise GrblError(Code.INVALID_STATEMENT)
    value, place = read_number(line, place + 1)
    if place != len(line):
        raise GrblError(Code.INVALID_STATEMENT)
    return int(number), value


def restore(line: str, eeprom: Eeprom) -> None:
    """Do what $RST=$, $RST=# and $RST=* do to the EEPROM."""
    restorers = {
        "$RST=$": eeprom.restore_settings,
        "$RST=#": eeprom.restore_places,
        "$RST=*": eeprom.restore_all,
    }
    if line not in restorers:
        raise GrblError(Code.INVALID_STATEMENT)
    restorers[line]()


def _store_startup_line(line: str, eeprom: Eeprom, state: State) -> None:
    number, place = read_number(line, 2)
    if line[place : place + 1] != "=" or number not in (0, 1):
        raise GrblError(Code.INVALID_STATEMENT)
    if state is not State.IDLE:
        raise GrblError(Code.NOT_IDLE)
    text = line[place + 1 :]
    sort_words(text, AXES[: len(eeprom.zero)])
    eeprom.startup_lines[int(number)] = text
