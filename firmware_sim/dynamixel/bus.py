"""The servos' wire: instruction packets in, status packets out when they are due."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress

from firmware_sim.clock import Clock
from firmware_sim.dynamixel.control_table import BAUDS, Register
from firmware_sim.dynamixel.faults import FaultQueue, Reply
from firmware_sim.dynamixel.memory import Refusal
from firmware_sim.dynamixel.packets import (
    ALERT,
    BROADCAST,
    STATUS,
    ErrorCode,
    Instruction,
    Packet,
    PacketReader,
    build,
    build_status,
    crc16,
)
from firmware_sim.dynamixel.servo import Servo

RETURN_DELAY_UNIT_S = 2e-6
BYTE_PATIENCE_S = 0.1
"""After so long a gap a servo takes the rest of a packet for lost, and waits for the next header."""
CLEAR_POSITION = b'\x01DXL"'
"""What the Clear instruction must say, so that no stray packet loses the turns."""
RESET_KEEPS: dict[int, tuple[Register, ...]] = {
    0xFF: (),
    0x01: (Register.ID,),
    0x02: (Register.ID, Register.BAUD_RATE),
}
"""What the options of Factory Reset leave as it is."""
LEVELS: dict[int, int] = {Instruction.PING: 0, Instruction.READ: 1}
"""The status return level from which on an instruction is answered; all others want 2."""


class DynamixelBus:
    """One or more servos on a wire of Protocol 2.0.

    `feed` takes what the host wrote, and returns what the servos have sent by now; `feed(b"")` only lets time pass.
    """

    def __init__(self, clock: Clock, servos: Sequence[Servo]) -> None:
        self._clock = clock
        self.servos = tuple(servos)
        self._reader = PacketReader()
        self._outbox: list[Reply] = []
        self._registered: dict[int, bytes] = {}
        self._heard_s = clock()
        self.groups = True
        self.faults = FaultQueue()

    @property
    def baud(self) -> int:
        """The speed that the servos listen at."""
        return BAUDS[self.servos[0].memory[Register.BAUD_RATE]]

    def due_s(self) -> float | None:
        """When the next reply goes out, if one waits."""
        return min((reply.due_s for reply in self._outbox), default=None)

    def feed(self, content: bytes) -> bytes:
        for servo in self.servos:
            servo.advance()
        now_s = self._clock()
        if content:
            if now_s - self._heard_s > BYTE_PATIENCE_S:
                self._reader.clear()
            self._heard_s = now_s
            if self.faults.echo:
                self._outbox.append(Reply(now_s, content))
        for packet in self._reader.feed(self.faults.heard(content)):
            if packet.instruction != STATUS:  # the echo of another servo, or of our own reply
                self._obey(packet)
        return self._collect()

    def _collect(self) -> bytes:
        now_s = self._clock()
        ready = sorted((reply for reply in self._outbox if reply.due_s <= now_s), key=lambda reply: reply.due_s)
        self._outbox = [reply for reply in self._outbox if reply.due_s > now_s]
        return b"".join(reply.content for reply in ready)

    def _obey(self, packet: Packet) -> None:
        listening = [servo for servo in self.servos if servo.deaf_until_s <= self._clock()]
        if not packet.intact:
            for servo in listening:
                if servo.servo_id == packet.servo_id:
                    self._answer(servo, ErrorCode.CRC)
            return
        for servo in listening:
            servo.heard()
        shared = {
            Instruction.SYNC_READ: self._sync_read,
            Instruction.FAST_SYNC_READ: self._fast_sync_read,
            Instruction.SYNC_WRITE: self._sync_write,
            Instruction.BULK_READ: self._bulk_read,
            Instruction.FAST_BULK_READ: self._fast_bulk_read,
            Instruction.BULK_WRITE: self._bulk_write,
        }
        if packet.servo_id == BROADCAST and packet.instruction == Instruction.PING and not self.groups:
            return
        if packet.instruction in shared:
            if packet.servo_id == BROADCAST and self.groups:
                shared[Instruction(packet.instruction)]({servo.servo_id: servo for servo in listening}, packet)
            return
        for servo in sorted(listening, key=lambda servo: servo.servo_id):
            if packet.servo_id in (servo.servo_id, BROADCAST, servo.memory[Register.SHADOW_ID]):
                self._obey_alone(servo, packet)

    def _obey_alone(self, servo: Servo, packet: Packet) -> None:
        single: dict[int, Callable[[Servo, bytes], bytes]] = {
            Instruction.PING: _ping,
            Instruction.READ: _read,
            Instruction.WRITE: _write,
            Instruction.REG_WRITE: self._register,
            Instruction.ACTION: self._action,
            Instruction.FACTORY_RESET: _factory_reset,
            Instruction.REBOOT: _reboot,
            Instruction.CLEAR: _clear,
        }
        level = servo.memory[Register.STATUS_RETURN_LEVEL]
        servo_id = servo.servo_id
        error, parameters = ErrorCode.NONE, b""
        try:
            parameters = single.get(packet.instruction, _unknown)(servo, packet.parameters)
        except Refusal as refusal:
            error = refusal.code
        silent = packet.servo_id != servo_id and (packet.servo_id, packet.instruction) != (BROADCAST, Instruction.PING)
        if level >= LEVELS.get(packet.instruction, 2) and not silent:
            self._answer(servo, error, parameters, servo_id)

    def _answer(self, servo: Servo, error: ErrorCode, parameters: bytes = b"", servo_id: int | None = None) -> None:
        sender = servo.servo_id if servo_id is None else servo_id
        self._send(servo, build_status(sender, error | _alert(servo), parameters))

    def _send(self, servo: Servo, content: bytes) -> None:
        delay_s = servo.memory[Register.RETURN_DELAY_TIME] * RETURN_DELAY_UNIT_S
        self._outbox += self.faults.befall(Reply(self._clock() + delay_s, content))

    # Instructions that come in two steps

    def _register(self, servo: Servo, parameters: bytes) -> bytes:
        address, content = _address_and_content(parameters)
        servo.memory.parse_write(address, content)
        self._registered[servo.servo_id] = parameters
        servo.memory[Register.REGISTERED_INSTRUCTION] = 1
        return b""

    def _action(self, servo: Servo, _: bytes) -> bytes:
        parameters = self._registered.pop(servo.servo_id, None)
        if parameters is None:
            raise Refusal(ErrorCode.RESULT_FAIL)
        servo.memory[Register.REGISTERED_INSTRUCTION] = 0
        return _write(servo, parameters)

    # Instructions to many servos at once

    def _sync_read(self, servos: dict[int, Servo], packet: Packet) -> None:
        self._answer_in_turn(servos, _sync_wishes(packet.parameters))

    def _bulk_read(self, servos: dict[int, Servo], packet: Packet) -> None:
        self._answer_in_turn(servos, _bulk_wishes(packet.parameters))

    def _answer_in_turn(self, servos: dict[int, Servo], wishes: Iterator[tuple[int, int, int]]) -> None:
        for servo_id, address, length in wishes:
            if (servo := servos.get(servo_id)) is not None:
                error, content = _try_read(servo, address, length)
                self._answer(servo, error, content)

    def _fast_sync_read(self, servos: dict[int, Servo], packet: Packet) -> None:
        self._answer_together(servos, list(_sync_wishes(packet.parameters)))

    def _fast_bulk_read(self, servos: dict[int, Servo], packet: Packet) -> None:
        self._answer_together(servos, list(_bulk_wishes(packet.parameters)))

    def _answer_together(self, servos: dict[int, Servo], wishes: list[tuple[int, int, int]]) -> None:
        """Answer all in one packet: error, id, content and a CRC over everything so far, servo after servo."""
        present = [(servos[servo_id], address, length) for servo_id, address, length in wishes if servo_id in servos]
        if len(present) < len(wishes):
            return  # a servo is missing, and the chain breaks off
        length = 1 + sum(4 + length for _, _, length in present)
        whole = build(BROADCAST, STATUS, b"")[:5] + length.to_bytes(2, "little") + bytes([STATUS])
        for servo, address, count in present:
            error, content = _try_read(servo, address, count)
            whole += bytes([error | _alert(servo), servo.servo_id]) + content.ljust(count, b"\0")
            whole += crc16(whole).to_bytes(2, "little")
        if present:
            self._send(present[0][0], whole)

    def _sync_write(self, servos: dict[int, Servo], packet: Packet) -> None:
        if len(packet.parameters) < 4:
            return
        address, length = _two_words(packet.parameters)
        rest = packet.parameters[4:]
        for start in range(0, len(rest), 1 + length):
            _try_write(servos.get(rest[start]), address, rest[start + 1 : start + 1 + length])

    def _bulk_write(self, servos: dict[int, Servo], packet: Packet) -> None:
        rest = packet.parameters
        while len(rest) > 5:
            servo_id, (address, length) = rest[0], _two_words(rest[1:])
            _try_write(servos.get(servo_id), address, rest[5 : 5 + length])
            rest = rest[5 + length :]


def _alert(servo: Servo) -> int:
    return ALERT if servo.memory[Register.HARDWARE_ERROR_STATUS] else 0


def _two_words(parameters: bytes) -> tuple[int, int]:
    if len(parameters) < 4:
        raise Refusal(ErrorCode.DATA_LENGTH)
    return int.from_bytes(parameters[:2], "little"), int.from_bytes(parameters[2:4], "little")


def _address_and_content(parameters: bytes) -> tuple[int, bytes]:
    if len(parameters) < 3:
        raise Refusal(ErrorCode.DATA_LENGTH)
    return int.from_bytes(parameters[:2], "little"), parameters[2:]


def _ping(servo: Servo, _: bytes) -> bytes:
    model, firmware = servo.memory[Register.MODEL_NUMBER], servo.memory[Register.FIRMWARE_VERSION]
    return model.to_bytes(2, "little") + bytes([firmware])


def _read(servo: Servo, parameters: bytes) -> bytes:
    return servo.read(*_two_words(parameters))


def _write(servo: Servo, parameters: bytes) -> bytes:
    servo.write(*_address_and_content(parameters))
    return b""


def _unknown(_: Servo, __: bytes) -> bytes:
    raise Refusal(ErrorCode.INSTRUCTION)


def _reboot(servo: Servo, _: bytes) -> bytes:
    servo.reboot()
    return b""


def _factory_reset(servo: Servo, parameters: bytes) -> bytes:
    keep = RESET_KEEPS.get(parameters[0]) if len(parameters) == 1 else None
    if keep is None:
        raise Refusal(ErrorCode.DATA_RANGE)
    servo.factory_reset(*keep)
    return b""


def _clear(servo: Servo, parameters: bytes) -> bytes:
    if parameters != CLEAR_POSITION:
        raise Refusal(ErrorCode.DATA_RANGE)
    servo.clear_turns()
    return b""


def _try_read(servo: Servo, address: int, length: int) -> tuple[ErrorCode, bytes]:
    try:
        return ErrorCode.NONE, servo.read(address, length)
    except Refusal as refusal:
        return refusal.code, b""


def _try_write(servo: Servo | None, address: int, content: bytes) -> None:
    """Write without an answer, as sync and bulk writes go: what is refused is lost."""
    if servo is not None:
        with suppress(Refusal):
            servo.write(address, content)


def _sync_wishes(parameters: bytes) -> Iterator[tuple[int, int, int]]:
    if len(parameters) >= 4:
        address, length = _two_words(parameters)
        yield from ((servo_id, address, length) for servo_id in parameters[4:])


def _bulk_wishes(parameters: bytes) -> Iterator[tuple[int, int, int]]:
    for start in range(0, len(parameters) - 4, 5):
        address, length = _two_words(parameters[start + 1 :])
        yield parameters[start], address, length
