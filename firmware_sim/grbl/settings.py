"""The `$` settings: what is kept in the controller's EEPROM."""

from firmware_sim.grbl.errors import Code, GrblError

AXES = "XYZ"
Settings = dict[int, float]

_WHOLE = {0, 1, 2, 3, 4, 5, 6, 10, 13, 20, 21, 22, 23, 26, 32}
"""Settings that are printed without decimals."""

SOFT_LIMITS, HARD_LIMITS, HOMING = 20, 21, 22
HOMING_DIRECTIONS, HOMING_FEED, HOMING_SEEK, HOMING_DEBOUNCE_MS, HOMING_PULL_OFF = 23, 24, 25, 26, 27
REPORT_MASK, REPORT_INCHES = 10, 13
SPINDLE_MAX, SPINDLE_MIN = 30, 31
STEPS, RATE, ACCELERATION, TRAVEL = 100, 110, 120, 130
"""The first of three settings each, for X, Y and Z."""


def light_arm_settings(travel: tuple[float, float, float]) -> Settings:
    """Return settings for a light arm: a unit on X and Y is a degree, not a millimetre."""
    settings: Settings = {0: 10, 1: 25, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0, 10: 3, 11: 0.01, 12: 0.002, 13: 0}
    settings |= {20: 1, 21: 0, 22: 1, 23: 0, 24: 300, 25: 3000, 26: 25, 27: 1, 30: 1000, 31: 0, 32: 0}
    settings |= {STEPS + axis: 100 for axis in range(3)}
    settings |= {RATE + axis: 7200 for axis in range(3)}
    settings |= {ACCELERATION + axis: 500 for axis in range(3)}
    settings |= {TRAVEL + axis: length for axis, length in enumerate(travel)}
    return settings


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
        There is no such setting, the value is negative, or soft limits are asked for without homing.
    """
    if value < 0:
        raise GrblError(Code.NEGATIVE_VALUE)
    if number not in settings:
        raise GrblError(Code.INVALID_STATEMENT)
    if number == SOFT_LIMITS and value and not settings[HOMING]:
        raise GrblError(Code.SOFT_LIMITS_NEED_HOMING)
    settings[number] = float(int(value)) if number in _WHOLE else value
    if number == HOMING and not value:
        settings[SOFT_LIMITS] = 0


def of_axes(settings: Settings, first: int) -> tuple[float, float, float]:
    """Return the three settings that begin at `first`."""
    return settings[first], settings[first + 1], settings[first + 2]
