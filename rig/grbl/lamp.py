"""The arm's lamp on the spindle output of its GRBL controller."""

from rig.clock import Clock
from rig.config import SpindleLampConfig
from rig.errors import OutOfRangeError
from rig.grbl import codec
from rig.grbl.controller import GrblController

ANSWER_S = 2.0


class SpindleLamp:
    """Fits `rig.devices.Lights`, with one lamp."""

    def __init__(self, controller: GrblController, config: SpindleLampConfig, clock: Clock) -> None:
        self._controller, self._config, self._clock = controller, config, clock

    def check(self, lamp: int) -> None:
        """Refuse any lamp but the first."""
        if lamp != 0:
            raise OutOfRangeError(f"lights: lamp {lamp} does not exist; this rig has lamp 0 only")

    def switch_on(self, lamp: int = 0) -> None:
        """Light the lamp and wait until it is warm."""
        self.check(lamp)
        self._controller.command(codec.spindle_line(self._config.power), ANSWER_S)
        self._controller.finish_motion(ANSWER_S)
        self._clock.sleep(self._config.warm_up_s)

    def switch_off(self) -> None:
        """Darken the lamp."""
        self._controller.command(codec.spindle_line(0), ANSWER_S)
        self._controller.finish_motion(ANSWER_S)

    def close(self) -> None:
        """Give the controller's port back, which the arm does too."""
        self._controller.close()
