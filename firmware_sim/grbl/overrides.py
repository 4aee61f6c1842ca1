"""The real-time bytes that change speeds while things move: feed, rapids, spindle, coolant."""

from dataclasses import dataclass

FEED_RANGE, SPINDLE_RANGE = (10, 200), (10, 200)
FEED = {0x90: 0, 0x91: 10, 0x92: -10, 0x93: 1, 0x94: -1}
RAPID = {0x95: 100, 0x96: 50, 0x97: 25}
SPINDLE = {0x99: 0, 0x9A: 10, 0x9B: -10, 0x9C: 1, 0x9D: -1}
SPINDLE_STOP, FLOOD, MIST = 0x9E, 0xA0, 0xA1
"""Steps in per cent; zero means back to 100."""


@dataclass
class Overrides:
    """In per cent of what was programmed."""

    feed: int = 100
    rapid: int = 100
    spindle: int = 100

    def take(self, byte: int) -> bool:
        """Obey one of these bytes; returns whether anything changed."""
        before = (self.feed, self.rapid, self.spindle)
        if byte in FEED:
            self.feed = _stepped(self.feed, FEED[byte], FEED_RANGE)
        elif byte in RAPID:
            self.rapid = RAPID[byte]
        elif byte in SPINDLE:
            self.spindle = _stepped(self.spindle, SPINDLE[byte], SPINDLE_RANGE)
        return before != (self.feed, self.rapid, self.spindle)

    def as_tuple(self) -> tuple[int, int, int]:
        """Return them as the field Ov has them."""
        return self.feed, self.rapid, self.spindle


def _stepped(value: int, step: int, limits: tuple[int, int]) -> int:
    return max(limits[0], min(limits[1], value + step)) if step else 100
