"""A serial port that really exists: a pseudo-terminal with a state machine behind it."""

import os
import termios
import tty
from collections import deque
from contextlib import suppress
from typing import Protocol

from firmware_sim.clock import Clock

LOG_LENGTH = 200
_SPEEDS = {
    getattr(termios, f"B{baud}"): baud for baud in (9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000)
}


class SerialDevice(Protocol):
    """What a wire serves."""

    @property
    def baud(self) -> int:
        """The speed at which the device understands what it hears."""

    def feed(self, content: bytes) -> bytes:
        """Take what the host wrote, return what the device says now."""

    def due_s(self) -> float | None:
        """When the device has something to say by itself."""


class Wire:
    """One port. The slave's own handle stays open here, so that clients may come and go."""

    def __init__(self, device: SerialDevice, clock: Clock) -> None:
        self._device = device
        self._clock = clock
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        self.path = os.ttyname(self._slave)
        self._log: deque[tuple[float, str, str]] = deque(maxlen=LOG_LENGTH)

    def due_s(self) -> float | None:
        return self._device.due_s()

    def service(self) -> None:
        """Carry what waits from the host to the device, and back."""
        heard = self._read()
        if heard:
            self._note("in", heard)
        # At another speed the line carries only noise, which a device takes no notice of.
        in_step = self._client_baud() == self._device.baud
        said = self._device.feed(heard if in_step else b"")
        if said and in_step:
            self._note("out", said)
            with suppress(BlockingIOError):  # a client that does not read loses bytes, as on a real port
                os.write(self.master, said)

    def recent(self) -> list[tuple[float, str, str]]:
        """Return the last transfers: CLOCK_MONOTONIC in seconds, "in" or "out", bytes in hexadecimal."""
        return list(self._log)

    def close(self) -> None:
        os.close(self.master)
        os.close(self._slave)

    def _read(self) -> bytes:
        with suppress(BlockingIOError):
            return os.read(self.master, 4096)
        return b""

    def _client_baud(self) -> int | None:
        return _SPEEDS.get(termios.tcgetattr(self._slave)[5])

    def _note(self, direction: str, content: bytes) -> None:
        self._log.append((self._clock(), direction, content.hex()))
