"""The DMX side: 512 slots that are sent round and round, and what they were over the last seconds."""

import math
from bisect import bisect_right

from firmware_sim.motion import MEMORY_S
from firmware_sim.udmx.config import MOST_SLOTS

SLOT_S = 44e-6
"""Eleven bits at 250,000 a second."""
FRAME_S = 192e-6 + SLOT_S * (MOST_SLOTS + 1)
"""Break, start code, and all slots."""


class Dimmers:
    """Remembers the slots as the dimmers have received them."""

    def __init__(self, now_s: float) -> None:
        self._changes: list[tuple[float, bytes]] = [(now_s, bytes(MOST_SLOTS))]

    @property
    def slots(self) -> bytes:
        """Return the values that will be there once the line has carried them."""
        return self._changes[-1][1]

    def set(self, first: int, values: bytes, now_s: float) -> None:
        """Change slots; the dimmers hear of it in the next frame on the line."""
        slots = bytearray(self.slots)
        slots[first : first + len(values)] = values
        frame_s = (math.floor(now_s / FRAME_S) + 1) * FRAME_S
        self._remember(frame_s + SLOT_S * (first + len(values)), bytes(slots), now_s)

    def darken(self, now_s: float) -> None:
        """Lose everything at once, as without power."""
        self._remember(now_s, bytes(MOST_SLOTS), now_s)

    def slots_at(self, time_s: float) -> bytes:
        """Return what the dimmers had received at any time of the last seconds."""
        times_s = [change_s for change_s, _ in self._changes]
        return self._changes[max(0, bisect_right(times_s, time_s) - 1)][1]

    def _remember(self, change_s: float, slots: bytes, now_s: float) -> None:
        times_s = [time_s for time_s, _ in self._changes]
        old = max(0, bisect_right(times_s, now_s - MEMORY_S) - 1)
        still_true = [change for change in self._changes[old:] if change[0] <= change_s]
        self._changes = [*still_true, (change_s, slots)]
