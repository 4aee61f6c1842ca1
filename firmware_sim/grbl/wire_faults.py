"""Mishaps on the wire of a GRBL controller: lines lost, damaged or late, bytes that never arrive."""

import random
from collections import deque

from firmware_sim.clock import Clock
from firmware_sim.grbl.config import GrblFaults
from firmware_sim.grbl.controller import GrblController


class FaultyWire:
    """Fits `firmware_sim.wire.SerialDevice`: a controller behind a bad cable.

    Attributes
    ----------
    mute, garble, delay, duplicate : how many of the next lines from the controller are lost, get a flipped bit, are
        late by `delay_s`, come twice
    """

    def __init__(self, controller: GrblController, clock: Clock, faults: GrblFaults | None = None) -> None:
        self.controller = controller
        self._clock = clock
        self._shares = faults or GrblFaults()
        self._random = random.Random(self._shares.seed)  # noqa: S311  # mishaps, not secrets
        self._half = b""
        self._late: deque[tuple[float, bytes]] = deque()
        self._drops: deque[int] = deque()
        self.clear()

    def clear(self) -> None:
        """Mend everything that waits for the next line or byte."""
        self.mute = self.garble = self.delay = self.duplicate = 0
        self.delay_s = self._shares.delay_s
        self.bit = 3
        self._drops.clear()

    def drop_heard(self, after: int, count: int = 1) -> None:
        """Lose bytes from the host: some, after so many that arrive."""
        self._drops.extend([after, *[0] * (count - 1)])

    @property
    def baud(self) -> int:
        return self.controller.baud

    def due_s(self) -> float | None:
        due_s = self.controller.due_s()
        if not self._late:
            return due_s
        return self._late[0][0] if due_s is None else min(due_s, self._late[0][0])

    def feed(self, content: bytes) -> bytes:
        heard = bytes(byte for byte in content if not self._is_dropped())
        *lines, self._half = (self._half + self.controller.feed(heard)).split(b"\n")
        said = b"".join(self._befall(line + b"\n") for line in lines)
        now_s = self._clock()
        late = b""
        while self._late and self._late[0][0] <= now_s:
            late += self._late.popleft()[1]
        return late + said

    def _is_dropped(self) -> bool:
        if self._drops:
            if self._drops[0]:
                self._drops[0] -= 1
                return False
            self._drops.popleft()
            return True
        return self._random.random() < self._shares.drop_byte if self._shares.drop_byte else False

    def _befall(self, line: bytes) -> bytes:
        if not line.strip():
            return line
        if self._strikes("mute", self._shares.mute):
            return b""
        if self._strikes("garble", self._shares.garble):
            place = self.bit % (8 * len(line.rstrip()))
            line = bytes(byte ^ (1 << place % 8 if i == place // 8 else 0) for i, byte in enumerate(line))
            self.bit += 11  # another one the next time
        if self._strikes("duplicate", 0.0):
            line = line + line
        if self._late or self._strikes("delay", self._shares.delay):  # what comes behind a late line is late too
            self._late.append((max(self._clock() + self.delay_s, self._late[-1][0] if self._late else 0.0), line))
            return b""
        return line

    def _strikes(self, name: str, share: float) -> bool:
        left = getattr(self, name)
        if left:
            setattr(self, name, left - 1)
            return True
        return self._random.random() < share if share else False
