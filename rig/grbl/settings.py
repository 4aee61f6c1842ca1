"""The `$` settings that RIG.toml wants a controller to have; they are kept in its EEPROM."""

from collections.abc import Mapping

from rig.errors import DeviceError
from rig.grbl import commands
from rig.grbl.controller import GrblController

SOFT_LIMITS, FULL_POWER = 20, 30
STEPS, RATE, TRAVEL = 100, 110, 130
"""The first of as many settings each as there are axes."""


def ensure_settings(controller: GrblController, wanted: Mapping[int, float]) -> None:
    """Change the settings that differ, and read them back.

    Raises
    ------
    DeviceError
        One cannot be changed, or not any more.
    """
    if not wanted:
        return
    kept = controller.settings()
    differing = {number: value for number, value in wanted.items() if kept.get(number) != value}
    if differing and controller.hangs_on_settings:
        names = ", ".join(f"${number}" for number in differing)
        raise DeviceError(
            f"{controller.name}: {names} cannot be changed after a reset; switch it off and on, and try again"
        )
    for number, value in differing.items():
        controller.command(commands.SetSetting(number, value))
    kept = controller.settings(anew=True) if differing else kept
    for number, value in differing.items():
        if kept.get(number) != value:
            raise DeviceError(
                f"{controller.name}: ${number} is {kept.get(number)}, not {value:g}; mend settings in RIG.toml"
            )
