"""A GRBL controller: does it answer, what does it run, and is it set as a rig needs it."""

from collections.abc import Sequence
from contextlib import closing

import serial

from rig.config import SpindleLampConfig
from rig.doctor import controller_wire
from rig.doctor.bench import Bench
from rig.doctor.controller_wire import BAUD, BOOT_S, ControllerWire
from rig.doctor.finding import Finding, Findings, Part
from rig.doctor.port import try_port
from rig.doctor.servo_wire import ServoWire

SERVO_BAUDS = (57_600, 1_000_000)
RESTING = ("Idle", "Alarm", "Check", "Sleep")
SOFT_LIMITS, HOMING, REPORTS_INCHES, LARGEST_SPINDLE, LASER = 20, 22, 13, 30, 32


def check_controller(bench: Bench, part_name: str, path: str, baud: int) -> Findings:
    """Look at the controller of the light arm, or of a turntable, without moving it."""
    part = Part(part_name)
    port, findings = try_port(bench, part, path, baud)
    yield from findings
    if port is None:
        return
    with closing(port):
        wire = ControllerWire(port, bench.clock)
        state = wire.state(min(BOOT_S, 0.75 * bench.left_s()))
        if not state:
            yield _silence(bench, part, port, path, baud)
            return
        yield from _firmware(part, wire.version())
        yield _state(part, state)
        if state.partition(":")[0] not in RESTING:
            return  # it tells its settings at rest only
        settings = wire.settings()
        if not settings:
            yield part.warning(
                "settings", "the controller does not tell its settings ($$)", "switch it off and on, and try again"
            )
            return
        yield from _settings(part, settings)
        if isinstance(bench.config.lights, SpindleLampConfig):
            yield _lamp(bench.config.lights, settings)


def _firmware(part: Part, version: str) -> Findings:
    if version.startswith("1.1") or "FluidNC" in version:
        yield part.ok("firmware", f"GRBL {version}")
    elif version:
        yield part.warning("firmware", f"says that it is {version}, not GRBL 1.1", "check that it speaks GRBL 1.1")
    else:
        yield part.warning("firmware", "does not say what it is ($I)", "check that it runs GRBL 1.1")


def _state(part: Part, state: str) -> Finding:
    main = state.partition(":")[0]
    if main == "Alarm":
        return part.ok("state", "locked until it is homed, as after power-up or an alarm")
    if main == "Idle":
        return part.ok("state", "idle")
    if main == "Door":
        return part.fault(
            "state", "its safety door input is open", "close it, or tie the input as the board's page says"
        )
    return part.warning("state", f"in state {state}, not at rest", "wait for its end, or switch it off and on")


def _settings(part: Part, settings: dict[int, float]) -> Findings:
    wrong: Sequence[tuple[int, bool, str, Finding]] = (
        (
            HOMING,
            False,
            "homing is on",
            part.fault(
                "homing", "homing is off ($22=0): the rig cannot find its zero", "wire the switches, send $22=1"
            ),
        ),
        (
            SOFT_LIMITS,
            False,
            "soft limits are on",
            part.warning("soft limits", "soft limits are off ($20=0)", "set $130 to $132 to the travel, then $20=1"),
        ),
        (
            REPORTS_INCHES,
            True,
            "",
            part.fault("units", "reports in inches ($13=1): every position would be misread", "send $13=0"),
        ),
    )
    for number, is_wrong_when_set, when_right, finding in wrong:
        if number not in settings:
            continue
        if bool(settings[number]) == is_wrong_when_set:
            yield finding
        elif when_right:
            yield part.ok(finding.name, when_right)


def _lamp(config: SpindleLampConfig, settings: dict[int, float]) -> Finding:
    part = Part("lights")
    largest = settings.get(LARGEST_SPINDLE, config.power)
    if config.power > largest:
        return part.warning(
            "power",
            f"power = {config.power:g} is beyond the output's largest value ($30={largest:g})",
            f"set power to {largest:g} at most, or send $30={config.power:g}",
        )
    output = "laser" if settings.get(LASER) else "spindle"
    return part.ok("output", f"the lamp hangs on the {output} output; power {config.power:g} of {largest:g}")


def _silence(bench: Bench, part: Part, port: serial.Serial, path: str, baud: int) -> Finding:
    if baud != BAUD and controller_wire.answers(port, bench.clock):
        return part.fault(
            "baud",
            f"the controller answers at {BAUD} baud, RIG.toml says {baud}",
            f"set baud = {BAUD} in [{part.name}]",
        )
    for servo_baud in SERVO_BAUDS:
        port.baudrate = servo_baud
        if ServoWire(port, bench.clock).ping_all(0.1).statuses:
            return part.fault("answer", f"a servo answers on {path}", "swap the ports of [turntable] and [arm]")
    return part.fault(
        "answer",
        f"no GRBL controller answers on {path} at {baud} baud",
        "check its power and cable, and that GRBL 1.1 is flashed on it",
    )
