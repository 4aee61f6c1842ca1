"""A serial port as the SDK's packet handler wants one.

The SDK's own is not opened exclusively, keeps a core busy while it waits, and trusts the wall clock.
"""

# ruff: noqa: N802  # the SDK asks for methods of these names

from typing import Protocol

from rig.clock import Clock

READ_PATIENCE_S = 0.002
"""How long one read waits for bytes, without work for the processor."""
IDLE_S = 0.0001
LATENCY_S = 0.034
"""What a reply may take beyond its time on the wire: two turns of the USB adapter's 16 ms, and a little."""
BITS_A_BYTE = 10


class ByteStream(Protocol):
    """What of a `serial.Serial` is used here."""

    def read(self, size: int = 1, /) -> bytes | None:
        """Return up to so many bytes, or fewer after `READ_PATIENCE_S`."""

    def write(self, content: bytes, /) -> int | None:
        """Send, and return how many bytes went."""

    def reset_input_buffer(self) -> None:
        """Forget what has come."""

    def close(self) -> None:
        """Let it go."""


class BusPort:
    """Takes the place of the SDK's `PortHandler`."""

    def __init__(self, stream: ByteStream, baud: int, clock: Clock) -> None:
        self.is_using = False
        self._stream, self._baud, self._clock = stream, baud, clock
        self._deadline_s = 0.0

    def clearPort(self) -> None:
        """Forget what has come."""
        self._stream.reset_input_buffer()

    def writePort(self, packet: list[int]) -> int:
        """Send bytes."""
        return self._stream.write(bytes(packet)) or 0

    def readPort(self, length: int) -> bytes:
        """Return what has come, after a short wait if it is less than asked for."""
        return self._read(length) if length > 0 else b""

    def getBaudRate(self) -> int:
        """Tell the speed."""
        return self._baud

    def setPacketTimeout(self, length: int) -> None:
        """Let the time for a reply of so many bytes begin."""
        self._deadline_s = self._clock.now_s() + length * BITS_A_BYTE / self._baud + LATENCY_S

    def setPacketTimeoutMillis(self, milliseconds: float) -> None:
        """Let a time begin."""
        self._deadline_s = self._clock.now_s() + milliseconds / 1000

    def isPacketTimeout(self) -> bool:
        """Tell whether it is over."""
        return self._clock.now_s() > self._deadline_s

    def throw_away(self) -> bytes:
        """Read for a moment; returns what came."""
        return self._read(4096)

    def close(self) -> None:
        """Let the port go."""
        self._stream.close()

    def _read(self, length: int) -> bytes:
        content = self._stream.read(length) or b""
        if not content:
            self._clock.sleep(IDLE_S)  # a stream in memory may not wait by itself
        return content
