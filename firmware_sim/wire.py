"""A serial port that really exists: a pseudo-terminal with a state machine behind it."""

import os
import termios
import tty
from collections import deque
from contextlib import suppress
from pathlib import Path
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
    """One port. The slave's own handle stays open here, so that clients may come and go.

    Parameters
    ----------
    link : a path that always leads to the port, as udev's links by serial number do
    """

    def __init__(self, device: SerialDevice, clock: Clock, link: Path | None = None) -> None:
        self._device = device
        self._clock = clock
        self._link = link
        self._log: deque[tuple[float, str, str]] = deque(maxlen=LOG_LENGTH)
        self._slave = -1
        self.master: int | None = None
        self.path = ""
        self._plug_in()

    def due_s(self) -> float | None:
        return self._device.due_s()

    def service(self) -> None:
        """Carry what waits from the host to the device, and back."""
        if self.master is None:
            self._device.feed(b"")  # its time passes all the same, and what it says is lost
            return
        heard = self._read(self.master)
        if heard:
            self._note("in", heard)
        # At another speed the line carries only noise, which a device takes no notice of.
        in_step = self._client_baud() == self._device.baud
        said = self._device.feed(heard if in_step else b"")
        if said and in_step:
            self._note("out", said)
            with suppress(BlockingIOError):  # a client that does not read loses bytes, as on a real port
                os.write(self.master, said)

    def unplug(self) -> None:
        """Let the port vanish under whoever has it open."""
        if self.master is not None:
            self._note("unplugged", b"")
            os.close(self.master)
            os.close(self._slave)
            self.master = None
            if self._link is not None:
                self._link.unlink(missing_ok=True)

    def replug(self) -> str:
        """Plug it in again, and return its new name, which it did not have before."""
        self.unplug()
        self._plug_in()
        return self.path

    def _plug_in(self) -> None:
        before = self.path
        master, slave = os.openpty()
        if os.ttyname(slave) == before:
            spare = (master, slave)
            master, slave = os.openpty()
            for descriptor in spare:
                os.close(descriptor)
        tty.setraw(slave)
        os.set_blocking(master, False)
        self.master, self._slave, self.path = master, slave, os.ttyname(slave)
        if self._link is not None:
            self._link.parent.mkdir(exist_ok=True)
            self._link.unlink(missing_ok=True)
            self._link.symlink_to(self.path)

    def recent(self) -> list[tuple[float, str, str]]:
        """Return the last transfers: CLOCK_MONOTONIC in seconds, "in", "out" or "unplugged", bytes in hexadecimal."""
        return list(self._log)

    def close(self) -> None:
        self.unplug()

    def _read(self, master: int) -> bytes:
        with suppress(BlockingIOError):
            return os.read(master, 4096)
        return b""

    def _client_baud(self) -> int | None:
        return _SPEEDS.get(termios.tcgetattr(self._slave)[5])

    def _note(self, direction: str, content: bytes) -> None:
        self._log.append((self._clock(), direction, content.hex()))
