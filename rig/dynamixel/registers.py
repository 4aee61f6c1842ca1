"""The control table of the X series, as far as the turntable needs it, and its units."""

import math
from typing import NamedTuple


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


OPERATING_MODE = Register("operating mode", 11, 1)
TORQUE_ENABLE = Register("torque enable", 64, 1)
HARDWARE_ERROR = Register("hardware error status", 70, 1)
PROFILE_ACCELERATION = Register("profile acceleration", 108, 4)
PROFILE_VELOCITY = Register("profile velocity", 112, 4)
GOAL_POSITION = Register("goal position", 116, 4, signed=True)
MOVING = Register("moving", 122, 1)
PRESENT_POSITION = Register("present position", 132, 4, signed=True)

EXTENDED_POSITION_MODE = 4
TICKS_PER_TURN = 4096
DEG_PER_TICK = 360 / TICKS_PER_TURN
VELOCITY_UNIT_DEG_S = 0.229 * 360 / 60
ACCELERATION_UNIT_DEG_S2 = 214.577 * 360 / 60**2

MODEL_NUMBERS = {
    "XL430-W250": 1060,
    "2XL430-W250": 1090,
    "XC430-W150": 1070,
    "XC430-W240": 1080,
    "XM430-W210": 1030,
    "XM430-W350": 1020,
    "XM540-W150": 1130,
    "XM540-W270": 1120,
    "XH430-W210": 1010,
    "XH430-W350": 1000,
}

_HARDWARE_ERRORS = {
    0: "input voltage out of range",
    2: "overheating",
    3: "motor encoder fault",
    4: "electrical shock",
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
