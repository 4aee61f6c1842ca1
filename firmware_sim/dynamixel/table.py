"""What the servo's shaft carries: a table that may have slipped, behind gears that have play."""

from firmware_sim.clock import Clock
from firmware_sim.dynamixel.servo import Servo


class Table:
    """Lags behind a shaft that turns up, by the play of the gears, and lies against it when it turns down.

    Attributes
    ----------
    play_deg : how far it can be turned while the shaft stands still
    slip_deg : how far it is turned on its shaft for good
    """

    def __init__(self, servo: Servo, clock: Clock) -> None:
        self._servo, self._clock = servo, clock
        self._lag_deg = 0.0
        self._shaft_deg = servo.angle_deg(clock())
        self.play_deg = self.slip_deg = 0.0

    def advance(self) -> None:
        """Let the shaft carry it along."""
        shaft_deg = self._servo.angle_deg(self._clock())
        self._lag_deg = min(max(self._lag_deg + shaft_deg - self._shaft_deg, 0.0), self.play_deg)
        self._shaft_deg = shaft_deg

    def angle_deg(self, time_s: float) -> float:
        """Return where it stands, at any time of the last seconds."""
        return self._servo.angle_deg(time_s) - self._lag_deg + self.slip_deg
