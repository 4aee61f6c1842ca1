"""Protocol 2.0 as the doctor needs it: who is there, and what do they say, damaged answers included.

The SDK's own broadcast ping waits up to two seconds at each baud rate, and says nothing of damage.
"""

from dataclasses import dataclass
from typing import NamedTuple

import serial
from dynamixel_sdk import PacketHandler

from rig.clock import Clock

PING, READ, STATUS = 0x01, 0x02, 0x55
BROADCAST = 0xFE
HEADER = b"\xff\xff\xfd\x00"
ERROR_BITS = 0x7F
SLOT_S = 0.003
"""A servo waits this long for each id below its own before it answers a broadcast."""
ANSWER_S = 0.06
SILENCE_S = 0.1
LONGEST_DRAIN_S = 0.4
LONGEST_ANSWER = 40
"""In bytes, which at low baud rates need their time."""
POLL_S = 0.002
TRIES = 3

_crc_of = PacketHandler(2.0).updateCRC


class Status(NamedTuple):
    """An answer that came through whole."""

    servo_id: int
    error: int
    content: bytes


@dataclass(frozen=True)
class Heard:
    """What came in a while."""

    statuses: tuple[Status, ...]
    is_damaged: bool


class ServoWire:
    """A bus of servos behind an open port."""

    def __init__(self, port: serial.Serial, clock: Clock) -> None:
        self._port, self._clock = port, clock

    def ping(self, servo_id: int) -> Heard:
        """Ask one servo for its model number and firmware."""
        return self._ask(build(servo_id, PING), ANSWER_S, 1)

    def ping_all(self, window_s: float) -> Heard:
        """Ask all of them; those with high ids answer late."""
        return self._ask(build(BROADCAST, PING), window_s, 0)

    def read(self, servo_id: int, address: int, length: int) -> Heard:
        """Read a block of registers."""
        where = address.to_bytes(2, "little") + length.to_bytes(2, "little")
        return self._ask(build(servo_id, READ, where), ANSWER_S, 1)

    def drain(self) -> None:
        """Throw away what comes late, until nothing has come for a while."""
        start_s = last_s = self._clock.now_s()
        while self._clock.now_s() - last_s < SILENCE_S and self._clock.now_s() - start_s < LONGEST_DRAIN_S:
            if self._port.read(4096):
                last_s = self._clock.now_s()
            self._clock.sleep(POLL_S)

    def _ask(self, packet: bytes, window_s: float, enough: int) -> Heard:
        """Write a packet and listen; once enough answers are there, only a moment longer, for one too many."""
        self._port.reset_input_buffer()
        self._port.write(packet)
        wire_s = 10 * (len(packet) + LONGEST_ANSWER) / self._port.baudrate
        until_s = self._clock.now_s() + window_s + wire_s
        content = b""
        is_enough = False
        while self._clock.now_s() < until_s:
            arrived = bytes(self._port.read(4096))
            content += arrived
            if arrived and enough and not is_enough and len(parse(content).statuses) >= enough:
                is_enough, until_s = True, self._clock.now_s() + 2 * SLOT_S
            if not arrived:
                self._clock.sleep(POLL_S)
        return parse(content)


def build(servo_id: int, instruction: int, parameters: bytes = b"") -> bytes:
    """Make an instruction packet."""
    whole = HEADER + bytes([servo_id]) + (len(parameters) + 3).to_bytes(2, "little") + bytes([instruction]) + parameters
    return whole + _crc(whole)


def parse(content: bytes) -> Heard:
    """Take the status packets out of what came; our own packets, which some adapters echo, do not count."""
    statuses: list[Status] = []
    is_damaged = False
    while content:
        start = content.find(HEADER)
        is_damaged |= start != 0
        if start < 0:
            break
        content = content[start:]
        end = 7 + int.from_bytes(content[5:7], "little") if len(content) > 7 else len(content) + 1
        packet = content[:end]
        if len(packet) < end or end < 10 or _crc(packet[:-2]) != packet[-2:]:
            is_damaged = True
            content = content[len(HEADER) :]
            continue
        if packet[7] == STATUS and len(packet) >= 11:
            statuses.append(Status(packet[4], packet[8], packet[9:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")))
        content = content[end:]
    return Heard(tuple(statuses), is_damaged)


def _crc(content: bytes) -> bytes:
    return int(_crc_of(0, content, len(content))).to_bytes(2, "little")
