"""Ctrl-C and SIGTERM, as an operator means them.

In a session the first Ctrl-C asks for a pause after the step under way; the second, or SIGTERM or a hang-up, stops at
once. A single move has nothing to pause: its first Ctrl-C stops. While the rig is being stopped, impatience changes
nothing: further signals are not heard, so that none of them cuts the stop short.
"""

import signal
from types import FrameType, TracebackType
from typing import Self


class StopNow(KeyboardInterrupt):
    """Stop on the wire, now."""


class Interrupts:
    """A context manager that takes the signals over and gives them back."""

    def __init__(self, *, can_pause: bool) -> None:
        self.pause_requested = False
        self._can_pause = can_pause
        self._stopping = False
        self._before: dict[int, object] = {}

    def __enter__(self) -> Self:
        """Take over."""
        self._before = {
            signal.SIGINT: signal.signal(signal.SIGINT, self._on_interrupt),
            signal.SIGTERM: signal.signal(signal.SIGTERM, self._on_stop),
            signal.SIGHUP: signal.signal(signal.SIGHUP, self._on_stop),
        }
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]  # what signal.signal returned above

    def _on_interrupt(self, number: int, frame: FrameType | None) -> None:
        if self._can_pause and not self.pause_requested:
            self.pause_requested = True
        else:
            self._on_stop(number, frame)

    def _on_stop(self, number: int, frame: FrameType | None) -> None:
        if not self._stopping:
            self._stopping = True
            raise StopNow
