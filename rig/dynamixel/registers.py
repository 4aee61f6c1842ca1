"""The control table of the X series, as far as the turntable needs it, and its units."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from rig.dynamixel.models import MODELS, RESOLUTION


class Register(NamedTuple):
    """A place in the control table; values are little-endian, two's complement where signed."""

    name: str
    address: int
    size: int
    signed: bool = False

    def decode(self, raw: int) -> int:
        """Turn the unsigned number of the wire into the value."""
        return raw - (1 << 8 * self.size) if self.signed and raw >> (8 * self.size - 1) else raw

    def encode(self, value: int) -> int:
        """Turn a value into the unsigned number of the wire.

        Raises
        ------
        ValueError
            The value does not fit.
        """
        low, high = (
            (-(1 << 8 * self.size - 1), (1 << 8 * self.size - 1) - 1) if self.signed else (0, (1 << 8 * self.size) - 1)
        )
        if not low <= value <= high:
            raise ValueError(f"{value} does not fit into register {self.name} ({low}..{high})")
        return value & ((1 << 8 * self.size) - 1)

    def from_bytes(self, content: bytes) -> int:
        """Take the value out of the bytes of the wire."""
        return self.decode(int.from_bytes(content, "little"))

    def to_bytes(self, value: int) -> bytes:
        """Turn a value into the bytes of the wire; ValueError if it does not fit."""
        return self.encode(value).to_bytes(self.size, "little")


class Block(NamedTuple):
    """A stretch of the control table, read in one go.

    Status packets say how long they are, not what they are about. No two blocks are of one length, nor is any as short
    as a register, so that a reply that belongs to another question is known by its length.

    Attributes
    ----------
    restless : asked for again and again, so that an answer of a moment ago does no harm
    """

    name: str
    address: int
    size: int
    restless: bool = False

    def values(self, content: bytes) -> "Values":
        """Make the registers in it accessible."""
        return Values(self, content)


@dataclass(frozen=True)
class Values:
    """A block's registers as they were read."""

    block: Block
    content: bytes

    def __getitem__(self, register: Register) -> int:
        """Return the value of a register."""
        start = register.address - self.block.address
        return register.from_bytes(self.content[start : start + register.size])


MODEL_NUMBER = Register("model number", 0, 2)
FIRMWARE_VERSION = Register("firmware version", 6, 1)
DRIVE_MODE = Register("drive mode", 10, 1)
OPERATING_MODE = Register("operating mode", 11, 1)
TEMPERATURE_LIMIT = Register("temperature limit", 31, 1)
MAX_VOLTAGE_LIMIT = Register("max voltage limit", 32, 2)
MIN_VOLTAGE_LIMIT = Register("min voltage limit", 34, 2)
VELOCITY_LIMIT = Register("velocity limit", 44, 4)
TORQUE_ENABLE = Register("torque enable", 64, 1)
HARDWARE_ERROR = Register("hardware error status", 70, 1)
BUS_WATCHDOG = Register("bus watchdog", 98, 1, signed=True)
PROFILE_ACCELERATION = Register("profile acceleration", 108, 4)
PROFILE_VELOCITY = Register("profile velocity", 112, 4)
GOAL_POSITION = Register("goal position", 116, 4, signed=True)
MOVING = Register("moving", 122, 1)
PRESENT_POSITION = Register("present position", 132, 4, signed=True)
PRESENT_VOLTAGE = Register("present input voltage", 144, 2)
PRESENT_TEMPERATURE = Register("present temperature", 146, 1)

EEPROM = Block("settings", 0, 64)
STATE = Block("state", 64, 83)
"""Everything from torque enable to present temperature."""
GLANCE = STATE._replace(restless=True)
MOTION = Block("motion", 122, 14, restless=True)
"""From moving to present position: what is asked for again and again while the table turns."""

EXTENDED_POSITION_MODE = 4
TIME_BASED_PROFILE = 0b100
"""Bit of the drive mode: profile velocity and acceleration are times."""
WATCHDOG_OFF = 0
WATCHDOG_TRIPPED = -1
WATCHDOG_UNIT_S = 0.02
DEG_PER_TICK = 360 / RESOLUTION
VELOCITY_UNIT_DEG_S = 0.229 * 360 / 60
ACCELERATION_UNIT_DEG_S2 = 214.577 * 360 / 60**2

MODEL_NUMBERS = {model.name: model.number for model in MODELS}
ENCODER_FAULT = 1 << 3
_HARDWARE_ERRORS = {
    0: "input voltage out of range",
    2: "overheating",
    3: "motor encoder fault",
    4: "electrical shock or too little power",
    5: "overload",
}


def hardware_errors(status: int) -> str:
    """Say in words which bits of the hardware error status are set."""
    return ", ".join(_HARDWARE_ERRORS.get(bit, f"bit {bit}") for bit in range(8) if status >> bit & 1)


def velocity_units(speed_deg_s: float) -> int:
    """Return the profile velocity nearest to a servo speed, at least one unit, for zero means no limit."""
    return max(1, round(speed_deg_s / VELOCITY_UNIT_DEG_S))


def acceleration_units(acceleration_deg_s2: float) -> int:
    """Return the profile acceleration nearest to a servo acceleration, at least one unit."""
    return max(1, round(acceleration_deg_s2 / ACCELERATION_UNIT_DEG_S2))


def profile_time_s(way_deg: float, speed_deg_s: float, acceleration_deg_s2: float) -> float:
    """How long a trapezoid profile takes for a way, both speeds of the servo itself."""
    way_deg = abs(way_deg)
    if way_deg < speed_deg_s**2 / acceleration_deg_s2:
        return 2 * math.sqrt(way_deg / acceleration_deg_s2)
    return way_deg / speed_deg_s + speed_deg_s / acceleration_deg_s2
