"""The spindle output as a dimmer: what the lamp on the arm did, and when."""

from bisect import bisect_right

from firmware_sim.motion import MEMORY_S

DUTY_STEPS = 255


def duty(mode: int, speed: float, slowest: float, fastest: float) -> float:
    """Fraction of full power, 0..1, in the steps of the controller's 8-bit PWM.

    Parameters
    ----------
    mode : 3 or 4 for on, 5 for off; a lamp has no direction
    speed : the S word
    slowest, fastest : settings $31 and $30
    """
    if mode == 5 or speed <= 0:
        return 0.0
    if slowest >= fastest or speed >= fastest:
        return 1.0
    above = max(0.0, speed - slowest) / (fastest - slowest)
    return (int(above * (DUTY_STEPS - 1)) + 1) / DUTY_STEPS


class Lamp:
    """Power over the last seconds."""

    def __init__(self, now_s: float) -> None:
        self._changes: list[tuple[float, float]] = [(now_s, 0.0)]
        self.is_dead = False

    @property
    def power(self) -> float:
        return self._changes[-1][1]

    def set(self, power: float, now_s: float) -> None:
        if power != self.power:
            times = [time_s for time_s, _ in self._changes]
            old = max(0, bisect_right(times, now_s - MEMORY_S) - 1)
            self._changes = [*self._changes[old:], (now_s, power)]

    def power_at(self, time_s: float) -> float:
        """Fraction of full power at any time of the last seconds; none of it becomes light in a lamp that is dead."""
        if self.is_dead:
            return 0.0
        return self._changes[max(0, bisect_right(self._changes, (time_s, 2.0)) - 1)][1]
