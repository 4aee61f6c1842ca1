"""Packets of the Dynamixel Protocol 2.0: finding them in a stream of bytes, and making status packets."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

HEADER = b"\xff\xff\xfd\x00"
BROADCAST = 0xFE
STATUS = 0x55
LARGEST_LENGTH = 1024
"""A longer length field is noise: no instruction of ours needs it, and waiting for it would deafen the servo."""


class Instruction(IntEnum):
    """The instructions that the simulated servo knows."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    FACTORY_RESET = 0x06
    REBOOT = 0x08
    CLEAR = 0x10
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    FAST_SYNC_READ = 0x8A
    BULK_READ = 0x92
    BULK_WRITE = 0x93
    FAST_BULK_READ = 0x9A


class ErrorCode(IntEnum):
    """The low seven bits of a status packet's error byte."""

    NONE = 0
    RESULT_FAIL = 1
    INSTRUCTION = 2
    CRC = 3
    DATA_RANGE = 4
    DATA_LENGTH = 5
    DATA_LIMIT = 6
    ACCESS = 7


ALERT = 0x80
"""Bit 7 of the error byte: register 70 says what is wrong with the hardware."""


@dataclass(frozen=True)
class Packet:
    """An instruction packet as it came, with stuffing removed; `intact` says whether its CRC was right."""

    servo_id: int
    instruction: int
    parameters: bytes
    intact: bool


def _crc_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1) ^ 0x8005 if crc & 0x8000 else crc << 1
        table.append(crc & 0xFFFF)
    return tuple(table)


_CRC_TABLE = _crc_table()


def crc16(content: bytes, start: int = 0) -> int:
    """CRC-16 with polynomial 0x8005, initially 0, most significant bit first."""
    crc = start
    for byte in content:
        crc = ((crc << 8) & 0xFFFF) ^ _CRC_TABLE[(crc >> 8) ^ byte]
    return crc


def stuff(content: bytes) -> bytes:
    """Put a second FD behind each FF FF FD, so that no header appears within a packet."""
    return content.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")


def unstuff(content: bytes) -> bytes:
    """Undo `stuff`."""
    return content.replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")


def build(servo_id: int, instruction: int, parameters: bytes, *, stuffed: bool = True) -> bytes:
    """Make one packet. Fast read replies go out unstuffed, since that is how hosts take them."""
    body = bytes([instruction]) + parameters
    if stuffed:
        body = stuff(body)
    head = HEADER + bytes([servo_id]) + (len(body) + 2).to_bytes(2, "little") + body
    return head + crc16(head).to_bytes(2, "little")


def build_status(servo_id: int, error: int, parameters: bytes = b"") -> bytes:
    """Make the answer of a servo."""
    return build(servo_id, STATUS, bytes([error]) + parameters)


class PacketReader:
    """Cuts packets out of a stream that may come in any portions, with noise between."""

    def __init__(self) -> None:
        self._pending = b""

    def clear(self) -> None:
        self._pending = b""

    def feed(self, content: bytes) -> Iterator[Packet]:
        """Take bytes; yield the packets that are complete now."""
        self._pending += content
        while (packet := self._next()) is not None:
            yield packet

    def _next(self) -> Packet | None:
        while True:
            start = self._pending.find(HEADER)
            if start < 0:
                self._pending = self._pending[-3:]
                return None
            self._pending = self._pending[start:]
            if len(self._pending) < 7:
                return None
            length = int.from_bytes(self._pending[5:7], "little")
            if 3 <= length <= LARGEST_LENGTH:
                break
            self._pending = self._pending[1:]
        if len(self._pending) < 7 + length:
            return None
        whole, self._pending = self._pending[: 7 + length], self._pending[7 + length :]
        return _take_apart(whole)


def _take_apart(whole: bytes) -> Packet:
    body = unstuff(whole[7:-2])
    intact = crc16(whole[:-2]) == int.from_bytes(whole[-2:], "little")
    return Packet(whole[4], body[0], body[1:], intact)
