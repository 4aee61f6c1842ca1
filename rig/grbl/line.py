"""Lines in from a GRBL controller's port, commands out: no protocol beyond that."""

from typing import Protocol

import serial

from rig.clock import Clock
from rig.errors import GarbledReplyError, LinkTimeoutError
from rig.grbl import codec
from rig.grbl.codec import Reply
from rig.grbl.commands import RealTime
from rig.serial_port import open_serial

FIRST_POLL_S, POLL_S = 0.000_2, 0.002
LONGEST_LINE = 4096


class Port(Protocol):
    """What is asked of a serial port."""

    def read(self, size: int, /) -> bytes:
        """Return what has come, at once."""

    def write(self, content: bytes, /) -> int | None:
        """Send."""

    def close(self) -> None:
        """Give it back."""


class GrblLine:
    """An open port. It can be read by one thread only."""

    def __init__(self, path: str, baud: int, clock: Clock, port: Port | None = None) -> None:
        """Open the port, for this program alone, unless there is an open one.

        Raises
        ------
        PortError
            It is missing, forbidden or taken.
        """
        self.name = f"GRBL controller on {path}"
        self._clock = clock
        self._port: Port = port or open_serial(path, baud)
        self._pending = b""

    def write(self, content: bytes) -> None:
        """Send bytes."""
        try:
            self._port.write(content)
        except (serial.SerialException, OSError) as error:
            raise self._gone(error) from error

    def act(self, byte: RealTime) -> None:
        """Send a real-time byte."""
        self.write(byte.value)

    def next_reply(self, deadline_s: float, what: str) -> Reply:
        """Wait for the next line.

        Raises
        ------
        LinkTimeoutError
            None came in time, or the port went away.
        GarbledReplyError
            It is damaged, or never ends.
        """
        pause_s = FIRST_POLL_S
        while b"\n" not in self._pending:
            arrived = self._read()
            self._pending += arrived
            if len(self._pending) > LONGEST_LINE:
                self._pending = b""
                raise GarbledReplyError(f"{self.name}: endless line; check the baud rate")
            if not arrived:
                if self._clock.now_s() > deadline_s:
                    raise LinkTimeoutError(f"{self.name}: no answer to {what}; check power and cable")
                self._clock.sleep(pause_s)
                pause_s = min(2 * pause_s, POLL_S)  # most answers come at once, some after a long motion
        line, self._pending = self._pending.split(b"\n", 1)
        return codec.parse_line(line)

    def waiting(self) -> list[Reply]:
        """Take in what has come unasked; half a line waits for its rest, what is damaged is left out."""
        while arrived := self._read():
            self._pending = (self._pending + arrived)[-16 * LONGEST_LINE :]
        *lines, self._pending = self._pending.split(b"\n")
        replies = []
        for line in lines:
            try:
                replies.append(codec.parse_line(line))
            except GarbledReplyError:
                continue
        return replies

    def drain(self, silence_s: float) -> list[Reply]:
        """Take in everything until nothing has come for a while: late answers are nobody's."""
        replies = self.waiting()
        quiet_from_s = self._clock.now_s()
        while self._clock.now_s() - quiet_from_s < silence_s:
            self._clock.sleep(POLL_S)
            if more := self.waiting():
                replies += more
                quiet_from_s = self._clock.now_s()
        self._pending = b""
        return replies

    def close(self) -> None:
        """Give the port back."""
        self._port.close()

    def _read(self) -> bytes:
        try:
            return bytes(self._port.read(LONGEST_LINE))
        except (serial.SerialException, OSError, TypeError) as error:
            raise self._gone(error) from error

    def _gone(self, error: Exception) -> LinkTimeoutError:
        return LinkTimeoutError(f"{self.name}: the port went away ({error}); check the USB cable")
