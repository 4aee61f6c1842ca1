"""The arm's lamp on the spindle or laser output of its GRBL controller."""

from rig.clock import Clock
from rig.config import SpindleLampConfig
from rig.errors import DeviceError, OutOfRangeError
from rig.grbl.controller import GrblController
from rig.grbl.output import Output
from rig.grbl.settings import FULL_POWER


class SpindleLamp:
    """Fits `rig.devices.Lights`, with one lamp.

    The firmware has no watchdog, so the lamp is lit on credit: see `rig.grbl.output`. Laser mode ($32=1), which
    besides darkens the output on every hold, makes no difference here.
    """

    def __init__(self, controller: GrblController, config: SpindleLampConfig, clock: Clock) -> None:
        self._controller, self._config, self._clock = controller, config, clock
        self._output = Output(controller)

    def check(self, lamp: int) -> None:
        """Refuse any lamp but the first."""
        if lamp != 0:
            raise OutOfRangeError(f"lights: lamp {lamp} does not exist; this rig has lamp 0 only")

    def switch_on(self, lamp: int = 0) -> None:
        """Light the lamp for timeout_s from now, and wait until it is warm.

        Raises
        ------
        DeviceError
            The controller would dim it to its own full power, or the output does not stand where it was told.
        """
        self.check(lamp)
        full = self._controller.settings().get(FULL_POWER)
        if full is not None and self._config.power > full:
            raise DeviceError(
                f"lights: power {self._config.power:g} exceeds the controller's full power $30 = {full:g}; mend one "
                "of them"
            )
        self._output.light(self._config.power, self._config.timeout_s or None)
        self._clock.sleep(self._config.warm_up_s)

    def switch_off(self) -> None:
        """Darken the lamp."""
        self._output.darken()

    def close(self) -> None:
        """Give the controller's port back, which the arm does too."""
        self._controller.close()
