"""Ports with the simulator's state machines right behind them, on a clock that only sleep moves."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import serial

from firmware_sim.dynamixel.bus import DynamixelBus
from firmware_sim.dynamixel.control_table import BAUDS, Register
from firmware_sim.dynamixel.servo import Servo
from firmware_sim.grbl.controller import GrblController
from firmware_sim.grbl.settings import light_arm_settings
from rig.config import RigConfig
from rig.doctor.bench import Bench
from rig.doctor.finding import Finding
from rig.doctor.passive import PATIENCE_S
from rig.fakes import FakeClock

TABLE = {"turntable": {"port": "/dev/ttyTABLE"}}
ARM = {"arm": {"port": "/dev/ttyARM"}, "lights": {"kind": "grbl-spindle"}}


class FarEnd(Protocol):
    """What can be behind a port."""

    @property
    def baud(self) -> int: ...

    def feed(self, content: bytes) -> bytes: ...


class StatePort(serial.Serial):
    """A port that hands everything to a state machine at once."""

    def __init__(self, far_end: FarEnd, baud: int) -> None:
        super().__init__()
        self._far_end, self._said = far_end, b""
        self.baudrate = baud

    def write(self, content: Any, /) -> int:
        self._exchange(bytes(content))
        return len(content)

    def read(self, size: int = 1) -> bytes:
        self._exchange(b"")
        content, self._said = self._said[:size], self._said[size:]
        return content

    def reset_input_buffer(self) -> None:
        self._said = b""

    def close(self) -> None:
        pass

    def _exchange(self, content: bytes) -> None:
        in_step = self.baudrate == self._far_end.baud
        said = self._far_end.feed(content if in_step else b"")
        self._said += said if in_step else b""


class Silence:
    """Nobody."""

    baud = 57_600

    def feed(self, content: bytes) -> bytes:
        return b""


class Together:
    """Several devices on one wire, where a zero of one wins over the ones of all others."""

    def __init__(self, *far_ends: FarEnd) -> None:
        self._far_ends = far_ends
        self.baud = far_ends[0].baud

    def feed(self, content: bytes) -> bytes:
        said = [far_end.feed(content) for far_end in self._far_ends]
        longest = max(map(len, said))
        padded = (one.ljust(longest, b"\xff") for one in said)
        return bytes(min(bits) if len(set(bits)) == 1 else bits[0] & bits[1] for bits in zip(*padded, strict=True))


def servo(clock: FakeClock, servo_id: int = 1, baud: int = 57_600, at_deg: float = 30.0) -> Servo:
    made = Servo(clock.now_s, servo_id, at_deg)
    made.memory[Register.BAUD_RATE] = next(code for code, rate in BAUDS.items() if rate == baud)
    return made


def bus(clock: FakeClock, *servos: Servo) -> DynamixelBus:
    return DynamixelBus(clock.now_s, servos)


def controller(clock: FakeClock, **settings: float) -> GrblController:
    """A controller of a light arm; settings as `s22=0`."""
    changed = light_arm_settings((360.0, 90.0, 10.0)) | {int(key[1:]): value for key, value in settings.items()}
    return GrblController(clock.now_s, changed, (-60.0, -35.0, -5.0))


def bench(clock: FakeClock, far_end: FarEnd, tmp_path: Path, *sections: dict[str, Any], **changes: Any) -> Bench:
    """A rig whose every port leads to one far end, on a machine without any devices."""
    config = RigConfig.model_validate({key: value for section in sections for key, value in section.items()})
    roots = {"sys_root": tmp_path, "proc_root": tmp_path, "lock_root": tmp_path}
    others = {"open_port": lambda _, baud: StatePort(far_end, baud), **roots, **changes}
    return Bench(config, clock.now_s() + PATIENCE_S, tmp_path, clock=clock, **others)


def by_name(findings: Sequence[Finding]) -> dict[str, Finding]:
    """Findings by name; fails if two have one name."""
    named = {f"{finding.name}": finding for finding in findings}
    assert len(named) == len(findings), findings
    return named
