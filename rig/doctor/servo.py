"""A Dynamixel servo: does it answer, is it the right one and the only one of its id, and how does it feel."""

from collections.abc import Sequence
from contextlib import closing, suppress

import serial

from rig.config import TurntableConfig
from rig.doctor import controller_wire
from rig.doctor.bench import Bench
from rig.doctor.finding import Finding, Findings, Part
from rig.doctor.port import try_port
from rig.doctor.servo_wire import ERROR_BITS, SLOT_S, TRIES, ServoWire, Status
from rig.dynamixel.registers import MODEL_NUMBERS, hardware_errors

USUAL_BAUDS = (57_600, 1_000_000, 115_200, 2_000_000, 3_000_000, 4_000_000, 9_600)
OLDEST_FIRMWARE = 38
"""The first whose bus watchdog stops the servo when the host dies."""
FULL_WINDOW_S = 253 * SLOT_S + 0.05
SHORT_WINDOW_S = 0.25
CLASH_READS = 5
WARM_DEG = 10
NEARLY_V = 0.5

_MODEL_NAMES = {number: name for name, number in MODEL_NUMBERS.items()}


def check_servo(bench: Bench, config: TurntableConfig) -> Findings:
    """Look at the turntable's servo without moving it."""
    part = Part("turntable")
    port, findings = try_port(bench, part, config.port, config.baud)
    yield from findings
    if port is None:
        return
    with closing(port):
        wire = ServoWire(port, bench.clock)
        servo = _found(wire, config.id)
        if servo is None:
            yield _silence(bench, part, config, port)
            return
        yield from _identity(part, config, servo)
        yield _clash(part, wire, config.id)
        yield from _company(bench, part, wire, config.id)
        yield from _health(part, wire, config.id)


def _found(wire: ServoWire, servo_id: int) -> Status | None:
    for _ in range(2 * TRIES):
        heard = wire.ping(servo_id)
        for status in heard.statuses:
            if status.servo_id == servo_id and len(status.content) >= 3:
                return status
    return None


def _identity(part: Part, config: TurntableConfig, servo: Status) -> Findings:
    number, firmware = int.from_bytes(servo.content[:2], "little"), servo.content[2]
    found = _MODEL_NAMES.get(number, f"model number {number}")
    if number != MODEL_NUMBERS.get(config.model):
        yield part.fault(
            "model",
            f"servo {config.id} is a {found}, RIG.toml says {config.model}",
            f'set model = "{found}" in [turntable] if that is the servo you mean, else its id',
        )
    else:
        yield part.ok("model", f"servo {config.id} at {config.baud} baud is a {found}")
    if firmware < OLDEST_FIRMWARE:
        yield part.warning(
            "firmware",
            f"version {firmware}; before {OLDEST_FIRMWARE} the servo goes on when the computer dies",
            "update it with the maker's wizard",
        )
    else:
        yield part.ok("firmware", f"version {firmware}")


def _clash(part: Part, wire: ServoWire, servo_id: int) -> Finding:
    """Read what differs between any two servos: their clocks, loads and positions. Two of one id talk at once."""
    damaged = doubled = 0
    wire.drain()  # a late answer is not one too many
    for _ in range(CLASH_READS):
        heard = wire.read(servo_id, 120, 28)
        damaged += heard.is_damaged
        doubled += len(heard.statuses) > 1
        if not heard.statuses:
            wire.drain()
    if max(damaged, doubled) > CLASH_READS // 2:
        return part.fault(
            "id",
            f"answers of id {servo_id} collide ({damaged} of {CLASH_READS} damaged, {doubled} doubled): two servos "
            "have this id, or the cable is bad",
            "unplug all servos but one, give that one another id, then plug the others in again",
        )
    if damaged:
        return part.warning(
            "id", f"{damaged} of {CLASH_READS} answers of id {servo_id} were damaged", "check the cable and its ends"
        )
    return part.ok("id", f"one servo has id {servo_id}")


def _company(bench: Bench, part: Part, wire: ServoWire, servo_id: int) -> Findings:
    heard = wire.ping_all(min(FULL_WINDOW_S, bench.left_s()))
    others = sorted({status.servo_id for status in heard.statuses} - {servo_id})
    if heard.is_damaged:
        yield part.warning(
            "bus",
            "answers to a ping of all servos are damaged: two servos of another id clash, or the cable is bad",
            "plug the servos in one by one, and give each an id of its own",
        )
    elif others:
        yield part.ok("bus", f"other servos on the bus: id {', '.join(map(str, others))}")


def _health(part: Part, wire: ServoWire, servo_id: int) -> Findings:
    limits, errors, state = (_block(wire, servo_id, *block) for block in ((31, 5), (70, 1), (144, 3)))
    if limits is None or errors is None or state is None:
        yield part.fault(
            "registers",
            f"servo {servo_id} answers to pings and not to reads",
            "set its status return level (register 68) back to 2 with the maker's wizard; else check the cable",
        )
        return
    if errors[0]:
        yield part.fault(
            "hardware error",
            f"servo {servo_id}: {hardware_errors(errors[0])}",
            "remove the cause, then switch the servo's power off and on",
        )
    else:
        yield part.ok("hardware error", "none")
    hottest_c, temperature_c = limits[0], state[2]
    heat = f"{temperature_c} °C, its limit is {hottest_c} °C"
    if temperature_c >= hottest_c:
        yield part.fault("temperature", heat, "let it cool down, and lighten its load")
    elif temperature_c >= hottest_c - WARM_DEG:
        yield part.warning("temperature", heat, "let it cool down before a long session")
    else:
        yield part.ok("temperature", heat)
    yield _voltage(part, *(int.from_bytes(raw, "little") / 10 for raw in (state[:2], limits[1:3], limits[3:5])))


def _voltage(part: Part, volts: float, most: float, least: float) -> Finding:
    what = f"{volts:.1f} V, allowed are {least:.1f} to {most:.1f} V"
    if not least <= volts <= most:
        return part.fault("voltage", what, "check the power supply and its plug")
    if not least + NEARLY_V <= volts <= most - NEARLY_V:
        return part.warning("voltage", what, "use a supply of the servo's nominal voltage; it sags under load")
    return part.ok("voltage", what)


def _block(wire: ServoWire, servo_id: int, address: int, length: int) -> bytes | None:
    """Read a block of registers. No two blocks have one length, so that no late answer passes for another."""
    for _ in range(2 * TRIES):
        for status in wire.read(servo_id, address, length).statuses:
            if status.servo_id == servo_id and len(status.content) == length and not status.error & ERROR_BITS:
                return status.content
    return None


def _silence(bench: Bench, part: Part, config: TurntableConfig, port: serial.Serial) -> Finding:
    """Nobody answers as RIG.toml says: look for another baud rate, another id, another device."""
    wire = ServoWire(port, bench.clock)
    others = [baud for baud in USUAL_BAUDS if baud != config.baud]
    for baud in (config.baud, *others):
        ids, is_damaged = _who(bench, wire, port, config.id, baud)
        if baud == config.baud and ids:
            return part.fault(
                "id",
                f"no servo has id {config.id}; there is id {', '.join(map(str, ids))}",
                f"set id = {ids[0]} in [turntable], or give the servo id {config.id}",
            )
        if baud == config.baud and is_damaged:
            return part.fault(
                "id",
                f"all answers at {baud} baud are damaged: two servos have one id, or the cable is bad",
                "unplug all servos but one, give that one another id, then plug the others in again",
            )
        if ids:
            who = f"servo {config.id}" if config.id in ids else f"a servo of id {ids[0]}"
            return part.fault(
                "baud",
                f"{who} answers at {baud} baud, RIG.toml says {config.baud}",
                f"set baud = {baud} in [turntable], or the servo's own to {config.baud}",
            )
    if controller_wire.answers(port, bench.clock):
        return part.fault(
            "answer", f"a GRBL controller answers on {config.port}", "swap the ports of [turntable] and [arm]"
        )
    bauds = ", ".join(str(baud) for baud in (config.baud, *others))
    return part.fault(
        "answer",
        f"no servo answers on {config.port} at {bauds} baud",
        "check that the servo has power (its LED blinks when it comes on), and its cable to the adapter",
    )


def _who(bench: Bench, wire: ServoWire, port: serial.Serial, servo_id: int, baud: int) -> tuple[Sequence[int], bool]:
    """Say who answers at a baud rate, the wanted one first, and whether anything came that was damaged."""
    with suppress(serial.SerialException, OSError, ValueError):  # an adapter that does not have this rate
        port.baudrate = baud
        heard = wire.ping(servo_id)
        if not heard.statuses:
            again = wire.ping_all(min(SHORT_WINDOW_S, bench.left_s()))
            return sorted({status.servo_id for status in again.statuses}), heard.is_damaged or again.is_damaged
        return sorted({status.servo_id for status in heard.statuses}), heard.is_damaged
    return (), False
