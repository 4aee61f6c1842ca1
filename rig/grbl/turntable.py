"""A turntable on an axis of a GRBL controller, which counts steps and cannot see where the table is.

So its zero is where the table stood when the controller was switched on, or where homing has found a switch; and once
the count is lost, only a person or the switch brings it back. Nothing here homes, unlocks or sets zero unasked.
"""

import math

from rig.clock import Clock
from rig.devices import TurntablePose
from rig.errors import DeviceError, PositionLostError
from rig.grbl import commands
from rig.grbl.commands import AXES
from rig.grbl.config import StepperTurntableConfig
from rig.grbl.controller import GrblController
from rig.grbl.errors import KeptAlarmError, StillMovingError
from rig.grbl.settings import RATE, SOFT_LIMITS, STEPS, TRAVEL

GRACE_S = 3.0
TRIES = 3


class GrblTurntable:
    """Fits `rig.devices.Turntable`.

    Parameters
    ----------
    owns_controller : whether nothing else hangs on the controller, so that its motors may be switched off
    """

    def __init__(
        self, controller: GrblController, config: StepperTurntableConfig, clock: Clock, *, owns_controller: bool
    ) -> None:
        self._controller, self._config, self._clock = controller, config, clock
        self._owns_controller = owns_controller
        self._axis = AXES.index(config.axis)
        self._commanded_deg: float | None = None
        self._ready = False

    def home(self) -> None:
        """Check the controller's settings, and see that it knows where the table is.

        With `zero = "switch"` the homing cycle is run, unless the arm on the same controller has just done so.

        Raises
        ------
        DeviceError
            The axis does not exist, or its steps or limits are not those of RIG.toml.
        PositionLostError
            Zero is where the table stood, and that is not known any more; or a switch was not found.
        """
        self._ready = False
        self._controller.make_ready()
        self._controller.place(self._config.axis)
        self._check_settings()
        if self._config.zero == "switch":
            if self._owns_controller or not self._controller.homed:
                self._controller.home(self._config.homing_timeout_s)
        else:
            self._refuse_lost_position()
        self._ready = True

    def check(self, angle_deg: float) -> None:
        """Refuse an angle outside the limits of RIG.toml."""
        self._config.check_limits(angle_deg)

    def move_to(self, angle_deg: float) -> TurntablePose:
        """Go to an angle, from below by at least the backlash, and wait until the axis stands there.

        Raises
        ------
        OutOfRangeError
            Beyond the limits of RIG.toml; nothing moved.
        DeviceError, PositionLostError, LinkError
            Not homed, or not any more; the controller refused, is silent, or the table did not arrive.
        """
        config = self._config
        self.check(angle_deg)
        if not self._knows():
            raise DeviceError("turntable: not homed yet; home it first")
        here_deg = self.locate().angle_deg
        arrived = self._commanded_deg == angle_deg and abs(here_deg - angle_deg) <= config.tolerance_deg
        if not arrived and here_deg > angle_deg - config.backlash_deg:
            self._go(max(angle_deg - config.backlash_deg, config.min_deg), here_deg)
        self._go(angle_deg, here_deg)
        self._commanded_deg = angle_deg
        return self.locate()

    def locate(self) -> TurntablePose:
        """Ask the controller now; what it counts is what it has stepped, not what the table did."""
        angle_deg = (self._controller.place(self._config.axis) - self._config.origin_deg) * self._config.direction
        return TurntablePose(self._commanded_deg, 0.0 if math.isclose(angle_deg, 0.0, abs_tol=1e-9) else angle_deg)

    def stop(self) -> None:
        """Brake and keep the position; the motor holds as $1 has it (255: always)."""
        self._controller.halt()

    def release(self) -> None:
        """Let go: motors off, if a switch can find zero again and nothing else hangs on the controller.

        Otherwise the motor goes on holding, for the count would be lost.
        """
        self._ready = False
        if self._owns_controller and self._config.zero == "switch":
            self._controller.make_ready()
            self._controller.sleep()

    def close(self) -> None:
        """Give the port back; motors stay as they are."""
        self._controller.close()

    def _knows(self) -> bool:
        if self._config.zero == "switch":
            return self._ready and self._controller.homed
        return self._ready and not self._controller.lost

    def _go(self, angle_deg: float, from_deg: float) -> None:
        """Turn, and look whether it arrived; a line that was damaged on the wire is said again."""
        config = self._config
        goal = config.origin_deg + config.direction * angle_deg
        speed_deg_s = min(config.speed_deg_s, self._controller.settings().get(RATE + self._axis, math.inf) / 60)
        patience_s = 2 * (abs(angle_deg - from_deg) + config.backlash_deg) / speed_deg_s + GRACE_S
        for left in reversed(range(TRIES)):
            try:
                self._controller.command(commands.Move({config.axis: goal}, config.speed_deg_s))
                self._controller.finish_motion(patience_s)
            except (KeptAlarmError, StillMovingError):  # the goal lies inside and is near: the line was damaged
                self._controller.halt()
                if not left:
                    raise
                continue
            at_deg = self.locate().angle_deg
            if abs(at_deg - angle_deg) <= config.tolerance_deg:
                return
            if not left:
                raise DeviceError(
                    f"turntable: told to go to {angle_deg:.2f}°, stands at {at_deg:.2f}°; look what blocks it, then "
                    "run again"
                )

    def _check_settings(self) -> None:
        settings, config, name = self._controller.settings(), self._config, self._controller.name
        number = STEPS + self._axis
        steps = settings.get(number)
        if steps is None:
            raise DeviceError(
                f"{name}: does not tell ${number}, the steps of axis {config.axis}; is there such an axis?"
            )
        if config.steps_per_deg is not None and not math.isclose(steps, config.steps_per_deg, rel_tol=1e-3):
            raise DeviceError(
                f"{name}: axis {config.axis} has ${number} = {steps:g} steps a degree, RIG.toml says "
                f"{config.steps_per_deg:g}; mend one of them"
            )
        if steps <= 0 or 0.5 / steps > config.tolerance_deg:
            raise DeviceError(
                f"{name}: with ${number} = {steps:g} steps a degree the table cannot stand within "
                f"{config.tolerance_deg:g}° of every angle; widen tolerance_deg or use finer steps"
            )
        self._check_soft_limits(settings.get(TRAVEL + self._axis, 0.0) if settings.get(SOFT_LIMITS) else 0.0)

    def _check_soft_limits(self, travel: float) -> None:
        """Compare RIG.toml with the travel of the axis; none means that the controller does not watch it."""
        config = self._config
        ends = [config.origin_deg + config.direction * angle for angle in (config.min_deg, config.max_deg)]
        if travel and not (-travel - 1e-3 <= min(ends) and max(ends) <= 1e-3):
            raise DeviceError(
                f"{self._controller.name}: RIG.toml lets axis {config.axis} go {min(ends):g}..{max(ends):g}, the "
                f"controller's soft limits only {-travel:g}..0 (${TRAVEL + self._axis}); mend min_deg, max_deg or "
                f"origin_deg, or raise the travel and home to the other end"
            )

    def _refuse_lost_position(self) -> None:
        if self._controller.lost or self._controller.status().state != "Idle":
            raise PositionLostError(
                f"{self._controller.name}: locked after an alarm, so that the table's angle is not known; turn it to "
                'its zero mark, switch the controller off and on ($22=0 lets it start unlocked), or use zero = "switch"'
            )
