"""The spindle or laser output of a GRBL controller, lit on credit.

GRBL has no watchdog: an output that is on stays on if the host dies. So behind the line that lights it wait, in the
controller's own receive buffer, a dwell and a line that darkens it. The firmware itself puts it out then, with or
without us. Who goes on using it lights it again; who sends any other line ends the dwell first, by a soft reset, which
darkens at once and keeps the position, since nothing moves in a dwell.
"""

from rig.errors import GarbledReplyError, LinkTimeoutError
from rig.grbl import commands
from rig.grbl.controller import GrblController
from rig.grbl.errors import DimError, RefusedError

TRIES = 3
STOP_S = 2.0


class Output:
    """What hangs on a controller's output."""

    def __init__(self, controller: GrblController) -> None:
        self._controller = controller

    def light(self, power: float, limit_s: float | None) -> None:
        """Light it, for `limit_s` at most; None means until somebody darkens it, alive or not.

        Raises
        ------
        DimError
            It does not stand where it was told.
        DeviceError, LinkError
            The controller refused, or is silent.
        """
        for left in reversed(range(TRIES)):
            try:
                self._send(commands.Light(power), limit_s)
                self._check(power)
            except (RefusedError, GarbledReplyError, LinkTimeoutError, DimError):
                self._controller.reset()
                if not left:
                    raise
            else:
                return

    def darken(self) -> None:
        """Darken it, now; a locked controller has done so already, and a reset makes sure."""
        try:
            self._controller.command(commands.Dark(), STOP_S)
        except RefusedError:
            self._controller.reset()

    def _send(self, lit: commands.Light, limit_s: float | None) -> None:
        if limit_s is None:
            self._controller.command(lit)
        else:
            self._controller.send_guarded(lit, commands.Dwell(limit_s), commands.Dark())

    def _check(self, power: float) -> None:
        """Compare with what the report says: a lost digit or somebody's override dims the lamp."""
        told = self._controller.status().fields.get("FS", "").split(",")
        if len(told) == 2 and told[1].replace(".", "", 1).isdigit() and abs(float(told[1]) - power) > 1:
            raise DimError(
                f"{self._controller.name}: the output stands at {told[1]}, told was {power:g}; check $30, $31 and the "
                "overrides"
            )
