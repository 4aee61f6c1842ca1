"""The `$` settings: what is kept in the controller's EEPROM."""

from firmware_sim.grbl.errors import Code, GrblError

AXES = "XYZABC"
Settings = dict[int, float]

_WHOLE = {0, 1, 2, 3, 4, 5, 6, 10, 13, 20, 21, 22, 23, 26, 32, 44, 45, 46, 47}
"""Settings that are printed without decimals."""
_BYTES = {0, 1, 2, 3, 10, 23, 44, 45, 46, 47}
"""Settings that are kept in eight bits: more wraps around."""

IDLE_DELAY_MS = 1
SOFT_LIMITS, HARD_LIMITS, HOMING, LASER = 20, 21, 22, 32
HOMING_DIRECTIONS, HOMING_FEED, HOMING_SEEK, HOMING_DEBOUNCE_MS, HOMING_PULL_OFF = 23, 24, 25, 26, 27
REPORT_MASK, REPORT_INCHES = 10, 13
SPINDLE_MAX, SPINDLE_MIN = 30, 31
HOMING_CYCLES = (44, 45, 46, 47)
"""Bit masks of axes that home together, in this order; only grblHAL lets them be changed."""
STEPS, RATE, ACCELERATION, TRAVEL = 100, 110, 120, 130
"""The first of as many settings each as there are axes."""
SHORTEST_PULSE_US = 3


def light_arm_settings(travel: tuple[float, ...]) -> Settings:
    """Return settings for a light arm: a unit on X and Y is a degree, not a millimetre."""
    settings: Settings = {0: 10, 1: 25, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0, 10: 3, 11: 0.01, 12: 0.002, 13: 0}
    settings |= {20: 1, 21: 0, 22: 1, 23: 0, 24: 300, 25: 3000, 26: 25, 27: 1, 30: 1000, 31: 0, 32: 0}
    if len(travel) > 3:
        settings |= {44: 4, 45: 3, 46: 0, 47: 0}
    axes = range(len(travel))
    settings |= {STEPS + axis: 100 for axis in axes}
    settings |= {RATE + axis: 7200 for axis in axes}
    settings |= {ACCELERATION + axis: 500 for axis in axes}
    settings |= {TRAVEL + axis: travel[axis] for axis in axes}
    return settings


def axis_count(settings: Settings) -> int:
    """Return how many axes a controller with these settings has."""
    return sum(STEPS + axis in settings for axis in range(len(AXES)))


def homing_groups(settings: Settings) -> list[tuple[int, ...]]:
    """Return the axes that home together, group after group: Z, then X with Y, unless settings say otherwise."""
    masks = [int(settings.get(number, 0)) for number in HOMING_CYCLES]
    if HOMING_CYCLES[0] not in settings:
        masks = [0b100, 0b011]
    axes = range(axis_count(settings))
    groups = [tuple(axis for axis in axes if mask >> axis & 1) for mask in masks]
    return [group for group in groups if group]


def show(settings: Settings) -> str:
    """Print all of them, as `$$` does."""
    return "".join(
        f"${number}={value:.0f}\r\n" if number in _WHOLE else f"${number}={value:.3f}\r\n"
        for number, value in settings.items()
    )


def store(settings: Settings, number: int, value: float) -> None:
    """Change one of them, as `$n=v` does.

    Raises
    ------
    GrblError
        There is no such setting, the value is negative or too small, or soft limits are asked for without homing.
    """
    if value < 0:
        raise GrblError(Code.NEGATIVE_VALUE)
    if number not in settings:
        raise GrblError(Code.INVALID_STATEMENT)
    if number == 0 and value < SHORTEST_PULSE_US:
        raise GrblError(Code.SHORT_STEP_PULSE)
    if number == SOFT_LIMITS and value and not settings[HOMING]:
        raise GrblError(Code.SOFT_LIMITS_NEED_HOMING)
    if number in _BYTES:
        value = int(value) % 256
    settings[number] = float(int(value)) if number in _WHOLE else value
    if number == HOMING and not value:
        settings[SOFT_LIMITS] = 0


def of_axes(settings: Settings, first: int) -> tuple[float, ...]:
    """Return the settings of all axes that begin at `first`."""
    return tuple(settings[first + axis] for axis in range(axis_count(settings)))
