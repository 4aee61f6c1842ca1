"""What the server's child processes have in common: they ask over the side channel, and end with their parent."""

import select
import sys
from typing import Protocol

from firmware_sim.side_channel import Answer


class Requests(Protocol):
    """The side channel, as far as a child needs it."""

    def request(self, do: str, **parameters: object) -> Answer: ...


def wait_for_the_parent(seconds: float) -> None:
    """Let time pass, but not beyond the parent's end: it holds the other end of our standard input."""
    readable, _, _ = select.select([sys.stdin], [], [], seconds)
    if readable:
        raise SystemExit(0)
