"""Ctrl-C and SIGTERM, as an operator means them.

The first Ctrl-C asks for a pause after the step under way. The second, or SIGTERM or a hang-up, stops at once.
"""

import signal
from types import FrameType, TracebackType
from typing import Self


class StopNow(KeyboardInterrupt):
    """Stop on the wire, now."""


class Interrupts:
    """A context manager that takes the signals over and gives them back."""

    def __init__(self) -> None:
        self.pause_requested = False
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
        if self.pause_requested:
            raise StopNow
        self.pause_requested = True

    def _on_stop(self, number: int, frame: FrameType | None) -> None:
        raise StopNow
