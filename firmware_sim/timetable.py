"""What is to happen at an instant."""

from collections.abc import Callable

from firmware_sim.clock import Clock


class Timetable:
    """Actions, each with its time after the start."""

    def __init__(self, clock: Clock) -> None:
        self._clock, self._start_s = clock, clock()
        self._coming: list[tuple[float, Callable[[], object]]] = []

    def add(self, after_s: float | None, action: Callable[[], object]) -> None:
        """Let something happen once; None is never."""
        if after_s is not None:
            self._coming.append((self._start_s + after_s, action))

    def keep(self) -> None:
        """Do what is due."""
        now_s = self._clock()
        due = sorted((entry for entry in self._coming if entry[0] <= now_s), key=lambda entry: entry[0])
        self._coming = [entry for entry in self._coming if entry[0] > now_s]
        for _, action in due:
            action()
