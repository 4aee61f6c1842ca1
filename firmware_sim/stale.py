"""Pictures that must not pass for the present: how often they come, and what time they bear.

A client that waits for a picture of a pose gives up if none comes at all, or if too many come that are too old.
"""

from collections.abc import Callable

INTERVAL_S = 0.5
ROOM_S = 1.0
"""How far back the first one is dated if the stream has no picture before it."""


class StaleFrames:
    """The pictures that pass the time until the one of a pose at rest is there."""

    def __init__(self) -> None:
        self._due_s = 0.0
        self._episode: object = None
        self._after_s = self._before_s = 0.0
        self._number = 0

    def is_due(self, now_s: float) -> bool:
        """Tell whether it is time for another one."""
        if now_s < self._due_s:
            return False
        self._due_s = now_s + INTERVAL_S
        return True

    def stamp_s(self, episode: object, last_s: float | None, before_rest_s: Callable[[], float]) -> float:
        """Return the time of the next one; times rise, and stay before the rest.

        Parameters
        ----------
        episode : what is waited for
        last_s : time of the stream's last picture, None if there is none
        before_rest_s : asked once an episode for an instant at which the pose was not reached yet
        """
        if episode != self._episode:
            self._episode, self._number = episode, 0
            self._before_s = before_rest_s()
            is_between = last_s is not None and last_s < self._before_s
            self._after_s = last_s if is_between and last_s is not None else self._before_s - ROOM_S
        self._number += 1  # half of the way, two thirds, three quarters …
        return self._before_s - (self._before_s - self._after_s) / (self._number + 1)
