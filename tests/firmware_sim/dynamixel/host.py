"""A host that speaks to simulated servos, with the clock in its hands."""

from dataclasses import dataclass

from firmware_sim.dynamixel.bus import DynamixelBus
from firmware_sim.dynamixel.packets import Instruction, PacketReader, build
from firmware_sim.dynamixel.servo import Servo
from tests.firmware_sim.timing import HandClock

SIZES = {64: 1, 68: 1, 70: 1, 98: 1, 11: 1, 20: 4, 116: 4, 108: 4, 112: 4, 48: 4, 7: 1, 65: 1}


@dataclass(frozen=True)
class Status:
    servo_id: int
    error: int
    parameters: bytes

    @property
    def value(self) -> int:
        return int.from_bytes(self.parameters, "little", signed=True)


class Host:
    """Speaks to the bus and lets the return delay pass."""

    def __init__(self, *servo_ids: int, start_deg: float = 0.0) -> None:
        self.clock = HandClock()
        self.servos = [Servo(self.clock, servo_id, start_deg) for servo_id in servo_ids or (1,)]
        self.bus = DynamixelBus(self.clock, self.servos)

    @property
    def servo(self) -> Servo:
        return self.servos[0]

    def send(self, servo_id: int, instruction: int, parameters: bytes = b"") -> list[Status]:
        said = self.bus.feed(build(servo_id, instruction, parameters))
        self.clock.pass_s(0.001)
        return parse(said + self.bus.feed(b""))

    def read(self, register: int, size: int = 4) -> int:
        (status,) = self.send(1, Instruction.READ, register.to_bytes(2, "little") + size.to_bytes(2, "little"))
        assert status.error & 0x7F == 0
        return status.value

    def write(self, register: int, value: int) -> int:
        """Write a register of its own size and return the error byte."""
        content = value.to_bytes(SIZES[register], "little", signed=value < 0)
        (status,) = self.send(1, Instruction.WRITE, register.to_bytes(2, "little") + content)
        return status.error

    def torque_on(self, *, mode: int = 4) -> None:
        assert self.write(11, mode) == 0
        assert self.write(64, 1) == 0


def parse(content: bytes) -> list[Status]:
    packets = list(PacketReader().feed(content))
    assert all(packet.intact and packet.instruction == 0x55 for packet in packets)
    return [Status(packet.servo_id, packet.parameters[0], packet.parameters[1:]) for packet in packets]


def counts(angle_deg: float) -> int:
    return round(angle_deg * 4096 / 360)
