"""Lamps that nobody switches, such as the fixed lights of an AMC session."""

from rig.config import AlwaysOnConfig
from rig.drivers import Driver
from rig.errors import OutOfRangeError


class AlwaysOn:
    """Fits `rig.devices.Lights`."""

    def check(self, lamp: int) -> None:
        """Refuse any lamp but the first, which stands for all."""
        if lamp != 0:
            raise OutOfRangeError(f"lights: lamp {lamp} does not exist; this rig's lights are always on")

    def switch_on(self, lamp: int = 0) -> None:
        """Do nothing: it is on."""
        self.check(lamp)

    def switch_off(self) -> None:
        """Do nothing: a person does."""

    def close(self) -> None:
        """Nothing to give back."""


DRIVER = Driver(AlwaysOnConfig, lambda config, bench: AlwaysOn())
