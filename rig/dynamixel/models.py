"""The servos of the X series as data, in the words of their manual."""

from typing import Literal, NamedTuple

BAUD_RATES = (9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000)
RESOLUTION = 4096
"""Pulses a revolution, of every model here."""
FARTHEST_POSITION = 1_048_575
"""Largest goal position of the extended position mode, ±256 revolutions."""
BUS_WATCHDOG_SINCE = 38
"""Firmware version from which on there is a bus watchdog."""


class Model(NamedTuple):
    """What one model can do.

    Attributes
    ----------
    name, number : as on the label, and as the register Model Number has it
    input_v : lowest and highest input voltage
    no_load_speed_rpm : at the highest voltage of the performance table
    feedback : whether register 126 tells the load or the current
    """

    name: str
    number: int
    input_v: tuple[float, float]
    no_load_speed_rpm: int
    feedback: Literal["load", "current"]


MODELS = (
    Model("XL330-M077", 1190, (3.7, 6.0), 456, "current"),
    Model("XL330-M288", 1200, (3.7, 6.0), 123, "current"),
    Model("XC330-T181", 1210, (6.5, 12.0), 113, "current"),
    Model("XC330-T288", 1220, (6.5, 12.0), 71, "current"),
    Model("XC330-M181", 1230, (3.7, 6.0), 155, "current"),
    Model("XC330-M288", 1240, (3.7, 6.0), 97, "current"),
    Model("XL430-W250", 1060, (6.5, 12.0), 61, "load"),
    Model("2XL430-W250", 1090, (6.5, 12.0), 61, "load"),
    Model("XC430-W150", 1070, (6.5, 14.8), 106, "load"),
    Model("XC430-W240", 1080, (6.5, 14.8), 70, "load"),
    Model("2XC430-W250", 1160, (6.5, 14.8), 64, "load"),
    Model("XM430-W210", 1030, (10.0, 14.8), 95, "current"),
    Model("XM430-W350", 1020, (10.0, 14.8), 57, "current"),
    Model("XM540-W150", 1130, (10.0, 14.8), 66, "current"),
    Model("XM540-W270", 1120, (10.0, 14.8), 37, "current"),
    Model("XH430-W210", 1010, (10.0, 14.8), 62, "current"),
    Model("XH430-W350", 1000, (10.0, 14.8), 37, "current"),
    Model("XH430-V210", 1050, (24.0, 24.0), 52, "current"),
    Model("XH430-V350", 1040, (24.0, 24.0), 31, "current"),
    Model("XH540-W150", 1110, (10.0, 14.8), 86, "current"),
    Model("XH540-W270", 1100, (10.0, 14.8), 46, "current"),
    Model("XH540-V150", 1150, (24.0, 24.0), 60, "current"),
    Model("XH540-V270", 1140, (24.0, 24.0), 34, "current"),
    Model("XW540-T140", 1180, (10.0, 14.8), 88, "current"),
    Model("XW540-T260", 1170, (10.0, 14.8), 48, "current"),
)


def name_of(number: int) -> str:
    """Return the name of a model number, or the number itself if no model has it."""
    return next((model.name for model in MODELS if model.number == number), f"model number {number}")
