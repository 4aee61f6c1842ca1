"""Servos on one wire of Protocol 2.0, with retries that cannot mistake a late reply for the right one.

Status packets carry no register address: a reply that comes after its timeout would pass for the answer to the next
question. So nothing is asked after a failure before the missing reply has come, or the wire has been silent for long; a
reply counts only if it is as long as the question wants, a refusal only if it is said twice; and what is read waits
until every late reply must have come, unless it is asked for again and again. All that is written is absolute, so that
writing twice does no harm.
"""

import re
import termios
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple, Self

from dynamixel_sdk import (
    COMM_RX_TIMEOUT,
    COMM_SUCCESS,
    COMM_TX_FAIL,
    INST_PING,
    INST_READ,
    INST_REBOOT,
    INST_WRITE,
    PacketHandler,
)
from serial import SerialException

from rig.clock import Clock
from rig.dynamixel.models import BAUD_RATES
from rig.dynamixel.port import READ_PATIENCE_S, BusPort, ByteStream
from rig.dynamixel.registers import Block, Register
from rig.errors import DeviceError, GarbledReplyError, LinkTimeoutError, PortError
from rig.serial_port import open_serial

PROTOCOL = 2.0
TRIES = 3
SILENCE_S = 0.12
GAP_S = 0.01
"""Longer than any pause within what one servo says."""
LATEST_REPLY_S = 0.32
"""No reply is later than this."""
LONGEST_DRAIN_S = 2.0

_ALERT = 0x80
_STATUS = re.compile(rb"\xff\xff\xfd\x00...\x55", re.DOTALL)
_STATUS_ERRORS = {
    1: "could not process the instruction",
    2: "does not know the instruction",
    4: "refused the value: out of range",
    5: "refused the value: wrong length",
    6: "refused the value: beyond its limit",
    7: "refused: the register is locked while torque is on, or read-only",
}
_BROKEN = (SerialException, OSError, termios.error)


class Identity(NamedTuple):
    """What a servo answers to a ping."""

    model_number: int
    firmware: int


@dataclass(frozen=True)
class Reply:
    """What a servo answered; `alert` says that its hardware error status has something to tell."""

    content: bytes
    alert: bool


class RefusedError(DeviceError):
    """A servo understood the instruction, and did not do it."""


class DynamixelBus:
    """All servos of one exclusively opened port.

    Parameters
    ----------
    stream : the opened port, whose reads wait `rig.dynamixel.port.READ_PATIENCE_S`
    name : what messages call it
    """

    def __init__(self, stream: ByteStream, name: str, baud: int, clock: Clock) -> None:
        self.name = name
        self._clock = clock
        self._port, self._packets = BusPort(stream, baud, clock), PacketHandler(PROTOCOL)
        self._uncertain = False
        self._owed = 0
        self._late_until_s = clock.now_s()
        self._alone: set[int] = set()

    @classmethod
    def open(cls, path: str, baud: int, clock: Clock) -> Self:
        """Open a port.

        Raises
        ------
        PortError
            It is missing, forbidden or taken, or no servo has such a baud rate.
        """
        if baud not in BAUD_RATES:
            raise PortError(
                f"{path}: no servo has a baud rate of {baud}; set the servo's own in RIG.toml, "
                f"one of {', '.join(map(str, BAUD_RATES))} (57600 as delivered)"
            )
        stream = open_serial(path, baud)
        stream.timeout = READ_PATIENCE_S
        return cls(stream, path, baud, clock)

    @property
    def uncertain(self) -> bool:
        """Whether the last exchange failed or was broken off, so that something may still be under way."""
        return self._uncertain

    def ping(self, servo_id: int) -> Identity:
        """Ask a servo who it is."""
        content = self._exchange(servo_id, INST_PING, b"", "ping", 3).content
        return Identity(int.from_bytes(content[:2], "little"), content[2])

    def scan(self, likely: Iterable[int] = ()) -> dict[int, Identity]:
        """Find servos: all at once, and those that are likely there but do not answer a broadcast, one by one."""
        self._settle()
        try:
            self._uncertain = True
            found, _ = self._packets.broadcastPing(self._port)
            self._uncertain = False
        except _BROKEN as error:
            raise self._gone(error) from error
        servos = {servo_id: Identity(*answer) for servo_id, answer in found.items()}
        for servo_id in likely:
            if servo_id not in servos:
                with suppress(LinkTimeoutError):
                    servos[servo_id] = self.ping(servo_id)
        return dict(sorted(servos.items()))

    def read(self, servo_id: int, place: Register | Block) -> Reply:
        """Read a register or a block of one servo."""
        question = place.address.to_bytes(2, "little") + place.size.to_bytes(2, "little")
        self._settle(patient=not (isinstance(place, Block) and place.restless))
        return self._exchange(servo_id, INST_READ, question, f"read {place.name}", place.size)

    def write(self, servo_id: int, register: Register, value: int) -> Reply:
        """Write a register, and wait until the servo says that it took it."""
        order = register.address.to_bytes(2, "little") + register.to_bytes(value)
        return self._exchange(servo_id, INST_WRITE, order, f"write {register.name}", 0)

    def shout(self, servo_id: int, register: Register, value: int) -> None:
        """Write a register at once, whatever is under way, and wait for nothing."""
        self._uncertain, self._port.is_using = True, False
        raw = list(register.to_bytes(value))
        try:
            self._packets.writeTxOnly(self._port, servo_id, register.address, register.size, raw)
        except _BROKEN as error:
            raise self._gone(error) from error

    def reboot(self, servo_id: int) -> None:
        """Let a servo start anew, which is the only way out of a shutdown; it is deaf for a moment."""
        self._exchange(servo_id, INST_REBOOT, b"", "reboot", 0)

    # Several servos at once

    def read_each(self, places: Mapping[int, Register | Block]) -> dict[int, Reply]:
        """Read something of each of several servos: in one instruction, or singly where that is not understood."""
        together = {servo_id: place for servo_id, place in places.items() if servo_id not in self._alone}
        found: dict[int, Reply] = {}
        if len(together) > 1:
            found = self._read_together(together)
        for servo_id, place in places.items():
            if servo_id not in found:
                found[servo_id] = self.read(servo_id, place)
                if servo_id in together and len(together) > 1:
                    self._alone.add(servo_id)
        return {servo_id: found[servo_id] for servo_id in places}

    def write_each(self, register: Register, values: Mapping[int, int]) -> None:
        """Write one register of several servos at the same instant; who did not take it is written to alone.

        Such a write is not answered, so it is read back.
        """
        if len(values) > 1 and not self._alone & values.keys():
            self._settle()
            block = b"".join(bytes([servo_id]) + register.to_bytes(value) for servo_id, value in values.items())
            try:
                self._packets.syncWriteTxOnly(self._port, register.address, register.size, list(block), len(block))
            except _BROKEN as error:
                raise self._gone(error) from error
            taken = self.read_each(dict.fromkeys(values, register))
            values = {n: value for n, value in values.items() if register.from_bytes(taken[n].content) != value}
        for servo_id, value in values.items():
            self.write(servo_id, register, value)

    def _read_together(self, places: Mapping[int, Register | Block]) -> dict[int, Reply]:
        """Return what comes of a sync or bulk read, which keeps to the order of ids; what is missing failed."""
        self._settle(patient=True)
        self._uncertain = True
        found: dict[int, Reply] = {}
        try:
            if self._ask_together(places) != COMM_SUCCESS:
                return {}
            for servo_id, place in places.items():
                content, result, error = self._packets.readRx(self._port, servo_id, place.size)
                if result != COMM_SUCCESS or error & ~_ALERT or len(content) != place.size:
                    self._owed, self._late_until_s = len(places) - len(found), self._clock.now_s() + LATEST_REPLY_S
                    return found
                found[servo_id] = Reply(bytes(content), bool(error & _ALERT))
        except _BROKEN as error:
            raise self._gone(error) from error
        self._uncertain = False
        return found

    def _ask_together(self, places: Mapping[int, Register | Block]) -> int:
        kinds = {(place.address, place.size) for place in places.values()}
        if len(kinds) == 1:
            ((address, size),) = kinds
            result: int = self._packets.syncReadTx(self._port, address, size, list(places), len(places), False)
            return result
        wishes = [
            byte
            for servo_id, place in places.items()
            for byte in (servo_id, *place.address.to_bytes(2, "little"), *place.size.to_bytes(2, "little"))
        ]
        result = self._packets.bulkReadTx(self._port, wishes, len(wishes), False)
        return result

    # The wire

    def drain(self, longest_s: float = LONGEST_DRAIN_S) -> None:
        """Throw away what is under way, until what was missing has come, or the wire has been silent for long."""
        start_s = last_s = self._clock.now_s()
        thrown = b""
        while self._clock.now_s() - start_s < longest_s:
            came = self._throw_away()
            if came:
                thrown, last_s = thrown + came, self._clock.now_s()
            missing = self._owed - len(_STATUS.findall(thrown))
            if self._clock.now_s() - last_s >= (SILENCE_S if missing > 0 else GAP_S):
                break
        self._owed = max(0, self._owed - len(_STATUS.findall(thrown)))
        self._uncertain, self._port.is_using = False, False

    def close(self) -> None:
        """Give the port back."""
        try:
            self._port.close()
        except _BROKEN as error:
            raise self._gone(error) from error

    def _settle(self, *, patient: bool = False) -> None:
        """Wait for silence after a failure; a patient one waits until no reply can come late any more."""
        if self._uncertain:
            self.drain()
        while patient and self._owed and self._clock.now_s() < self._late_until_s:
            self._throw_away()
        if self._clock.now_s() >= self._late_until_s:
            self._owed = 0
        self._port.is_using = False

    def _throw_away(self) -> bytes:
        try:
            return self._port.throw_away()
        except _BROKEN as error:
            raise self._gone(error) from error

    def _exchange(self, servo_id: int, instruction: int, parameters: bytes, what: str, size: int) -> Reply:
        result, refusals = COMM_RX_TIMEOUT, 0
        for _ in range(TRIES):
            self._settle()
            self._uncertain = True
            self._owed, self._late_until_s = self._owed + 1, self._clock.now_s() + LATEST_REPLY_S
            try:
                packet, result, error = self._packets.txRxPacket(
                    self._port, _request(servo_id, instruction, parameters)
                )
            except _BROKEN as broken:
                raise self._gone(broken) from broken
            if result != COMM_SUCCESS:
                continue
            self._owed -= 1
            content, refused = _parameters(packet), error & ~_ALERT
            refusals += refused in _STATUS_ERRORS
            if refusals > 1:
                self._uncertain = False
                raise RefusedError(f"servo {servo_id} on {self.name}: {what}: {_STATUS_ERRORS[refused]}")
            if not refused and content is not None and len(content) == size:
                self._uncertain = False
                return Reply(content, bool(error & _ALERT))
        raise self._failure(servo_id, what, result)

    def _failure(self, servo_id: int, what: str, result: int) -> LinkTimeoutError | GarbledReplyError:
        if result in (COMM_RX_TIMEOUT, COMM_TX_FAIL):
            return LinkTimeoutError(
                f"servo {servo_id} on {self.name}: no answer to {what} after {TRIES} tries; "
                "check power, cable, id and baud rate"
            )
        return GarbledReplyError(
            f"servo {servo_id} on {self.name}: damaged answers to {what} after {TRIES} tries; "
            "check the cable, and that no two servos have the same id"
        )

    def _gone(self, error: Exception) -> LinkTimeoutError:
        return LinkTimeoutError(f"{self.name}: the port went away ({error}); check the USB cable")


def _request(servo_id: int, instruction: int, parameters: bytes) -> list[int]:
    """Make an instruction packet as the SDK wants it: header, stuffing and checksum are its own matter."""
    length = len(parameters) + 3
    return [0, 0, 0, 0, servo_id, length & 0xFF, length >> 8, instruction, *parameters, 0, 0]


def _parameters(packet: list[int]) -> bytes | None:
    """Take the parameters out of a status packet, behind whose end the SDK may leave bytes; None if it has no error."""
    length = packet[5] | packet[6] << 8
    return bytes(packet[9 : 7 + length - 2]) if length >= 4 else None
