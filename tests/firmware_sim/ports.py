"""The real libraries on the simulated ports."""

import select
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import dynamixel_sdk
import serial

from firmware_sim.launch import RunningSim

BAUD = 57_600


def port_of(sim: RunningSim, name: str) -> str:
    port: str = sim.side_channel.status()["wires"][name]["port"]
    return port


class Turntable:
    """The SDK's port and packet handler for servo 1."""

    def __init__(self, port: str, baud: int = BAUD) -> None:
        self.port = dynamixel_sdk.PortHandler(port)
        self.packets = dynamixel_sdk.PacketHandler(2.0)
        assert self.port.setBaudRate(baud)

    def prepare(self, speed: int = 66) -> None:
        self.write1(64, 0)
        self.write1(11, 4)
        self.write1(64, 1)
        self.write4(108, 28)
        self.write4(112, speed)

    def write1(self, address: int, value: int) -> None:
        self._insist(lambda: (0, *self.packets.write1ByteTxRx(self.port, 1, address, value)))

    def write4(self, address: int, value: int) -> None:
        self._insist(lambda: (0, *self.packets.write4ByteTxRx(self.port, 1, address, value % 2**32)))

    def read4(self, address: int) -> int:
        value = self._insist(lambda: self.packets.read4ByteTxRx(self.port, 1, address))
        return value - 2**32 if value >= 2**31 else value

    def _insist(self, attempt: Callable[[], tuple[int, int, int]]) -> int:
        """Try thrice: on a busy machine the SDK's 34 ms pass before a process has had its turn."""
        for _ in range(3):
            value, result, error = attempt()
            if result == 0:
                assert error == 0
                return value
            self.drain()
        raise AssertionError(f"no answer, result {result}")

    def drain(self) -> None:
        """Read until nothing has come for a while."""
        while select.select([self.port.ser.fileno()], [], [], 0.12)[0]:
            self.port.clearPort()

    def go(self, counts: int) -> None:
        """Go there and wait for the end of the motion."""
        self.write4(116, counts)
        deadline_s = time.monotonic() + 10
        while self.read4(132) != counts or self._insist(lambda: self.packets.read1ByteTxRx(self.port, 1, 122)):
            assert time.monotonic() < deadline_s


@contextmanager
def turntable_of(sim: RunningSim, baud: int = BAUD) -> Iterator[Turntable]:
    table = Turntable(port_of(sim, "turntable"), baud)
    try:
        yield table
    finally:
        table.port.closePort()


class Arm:
    """A line at a time over pyserial."""

    def __init__(self, port: serial.Serial) -> None:
        self.port = port

    def ask(self, line: str) -> list[str]:
        """Send a line and return the answer up to its ok or error."""
        self.port.write(line.encode() + b"\n")
        said: list[str] = []
        while not said or not said[-1].startswith(("ok", "error")):
            received = self.port.readline()
            assert received, f"no answer to {line!r} but {said}"
            heard = received.decode().strip()
            if heard:
                said.append(heard)
        return said

    def home(self) -> None:
        self.port.write(b"\x18")
        while not (line := self.port.readline()).startswith(b"Grbl"):
            assert line or self.port.in_waiting
        for quick in ("$25=20000", "$120=5000", "$121=5000"):
            assert self.ask(quick)[-1] == "ok"
        assert self.ask("$H")[-1] == "ok"


@contextmanager
def arm_of(sim: RunningSim) -> Iterator[Arm]:
    with serial.Serial(port_of(sim, "arm"), 115_200, timeout=10) as port:
        yield Arm(port)
