"""The driver's bus on simulated servos, byte by byte, while no time passes but what is waited for."""

from collections.abc import Callable

from firmware_sim.dynamixel.bus import DynamixelBus as Firmware
from firmware_sim.dynamixel.servo import Servo
from firmware_sim.dynamixel.table import Table
from rig.config import TurntableConfig
from rig.dynamixel.bus import DynamixelBus
from rig.dynamixel.link import ServoLink
from rig.dynamixel.turntable import DynamixelTurntable
from rig.fakes import FakeClock

PATIENCE_S = 0.01
BAUD = 57_600
Change = Callable[[bytes], bytes]


class Hours(FakeClock):
    """A clock at whose instants something can happen."""

    def __init__(self) -> None:
        super().__init__(100.0)
        self._coming: list[tuple[float, Callable[[], object]]] = []

    def after(self, seconds: float, action: Callable[[], object]) -> None:
        self._coming.append((self.time_s + seconds, action))

    def sleep(self, seconds: float) -> None:
        until_s = self.time_s + seconds
        if not self._coming:
            self.time_s = max(self.time_s, until_s)
            return
        for due_s, action in sorted(
            (entry for entry in self._coming if entry[0] <= until_s), key=lambda entry: entry[0]
        ):
            self._coming.remove((due_s, action))
            self.time_s = max(self.time_s, due_s)
            action()
        self.time_s = max(self.time_s, until_s)


class Stream:
    """Fits `rig.dynamixel.port.ByteStream`: what a serial port would be, between host and servos."""

    def __init__(self, firmware: Firmware, clock: Hours, table: Table) -> None:
        self.firmware, self.clock, self.table = firmware, clock, table
        self.on_the_way_out: Change = bytes
        self.on_the_way_in: Change = bytes
        self.sent: list[tuple[float, bytes]] = []
        self.waiting = b""

    def write(self, content: bytes, /) -> int:
        self.sent.append((self.clock.time_s, content))
        self._take(self.firmware.feed(self.on_the_way_out(content)))
        return len(content)

    def read(self, size: int = 1, /) -> bytes:
        due_s = self.firmware.due_s()
        to_wait_s = PATIENCE_S if due_s is None else min(PATIENCE_S, due_s - self.clock.time_s + 1e-6)
        if not self.waiting and to_wait_s > 0:
            self.clock.sleep(to_wait_s)
            if to_wait_s == PATIENCE_S and not any(servo.is_turning() for servo in self.firmware.servos):
                return b""  # nobody has anything to say yet
        self._take(self.firmware.feed(b""))
        taken, self.waiting = self.waiting[:size], self.waiting[size:]
        return taken

    def reset_input_buffer(self) -> None:
        self._take(self.firmware.feed(b""))
        self.waiting = b""

    def close(self) -> None:
        self.waiting = b""

    def _take(self, said: bytes) -> None:
        self.table.advance()
        self.waiting += self.on_the_way_in(said) if said else b""


class Bench:
    """Servos on a bus, and the driver's end of it.

    Parameters
    ----------
    ids : of the servos
    start_deg : where their shafts stand
    """

    def __init__(self, *ids: int, start_deg: float = 0.0) -> None:
        self.clock = Hours()
        self.servos = [Servo(self.now_s, servo_id, start_deg) for servo_id in ids or (1,)]
        self.firmware = Firmware(self.now_s, self.servos)
        self.table = Table(self.servo, self.now_s)
        self.stream = Stream(self.firmware, self.clock, self.table)
        self.bus = DynamixelBus(self.stream, "bench", BAUD, self.clock)

    @property
    def servo(self) -> Servo:
        return self.servos[0]

    def now_s(self) -> float:
        return self.clock.time_s

    def turntable(self, **settings: float) -> DynamixelTurntable:
        config = TurntableConfig.model_validate({"port": "bench", **settings})
        return DynamixelTurntable(ServoLink(self.bus, 1), config, self.clock)
