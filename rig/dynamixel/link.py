"""Registers of one servo over Protocol 2.0, with retries that cannot mistake a late reply for the right one.

Status packets carry no register address: a reply that comes after its timeout would pass for the answer to the next
read. So after every failure the wire is drained until it has been silent for longer than any reply is late, and only
then is the question asked again. Goals are absolute, so that asking twice does no harm.
"""

import termios
from collections.abc import Callable
from typing import TypeVar

from dynamixel_sdk import COMM_RX_TIMEOUT, COMM_SUCCESS, COMM_TX_FAIL, PacketHandler
from serial import SerialException

from rig.clock import Clock
from rig.dynamixel.port import ExclusivePort
from rig.dynamixel.registers import Register
from rig.errors import DeviceError, GarbledReplyError, LinkTimeoutError, PortError
from rig.serial_port import port_error

PROTOCOL = 2.0
TRIES = 3
SILENCE_S = 0.12
LONGEST_DRAIN_S = 2.0

_ALERT = 0x80
_STATUS_ERRORS = {
    1: "could not process the instruction",
    2: "does not know the instruction",
    3: "received a damaged packet",
    4: "refused the value: out of range",
    5: "refused the value: wrong length",
    6: "refused the value: beyond its limit",
    7: "refused: the register is locked while torque is on, or read-only",
}

Answer = TypeVar("Answer")


class DynamixelLink:
    """One servo on an exclusively opened port."""

    def __init__(self, path: str, baud: int, servo_id: int, clock: Clock) -> None:
        """Open the port.

        Raises
        ------
        PortError
            It is missing, forbidden or taken, or has no such baud rate.
        """
        self.name = f"servo {servo_id} on {path}"
        self._path, self._id, self._clock = path, servo_id, clock
        self._port, self._packets = ExclusivePort(path), PacketHandler(PROTOCOL)
        try:
            opened = self._port.setBaudRate(baud)
        except (SerialException, OSError, termios.error) as error:
            raise port_error(path, error) from error
        if not opened:
            raise PortError(f"{path}: has no baud rate of {baud}; set the servo's own (57600 as delivered) in RIG.toml")

    def ping(self) -> int:
        """Return the servo's model number."""
        return self._persistently("ping", lambda: self._packets.ping(self._port, self._id))

    def read(self, register: Register) -> int:
        """Read a register."""
        reader = {
            1: self._packets.read1ByteTxRx,
            2: self._packets.read2ByteTxRx,
            4: self._packets.read4ByteTxRx,
        }[register.size]
        raw = self._persistently(f"read {register.name}", lambda: reader(self._port, self._id, register.address))
        return register.decode(raw)

    def write(self, register: Register, value: int) -> None:
        """Write a register, and wait until the servo says that it took it."""
        writer = {
            1: self._packets.write1ByteTxRx,
            2: self._packets.write2ByteTxRx,
            4: self._packets.write4ByteTxRx,
        }[register.size]
        raw = register.encode(value)

        def exchange() -> tuple[int, int, int]:
            result, error = writer(self._port, self._id, register.address, raw)
            return 0, result, error

        self._persistently(f"write {register.name}", exchange)

    def drain(self) -> None:
        """Throw away what is under way on the wire, until it has been silent for long enough."""
        start_s = last_s = self._clock.now_s()
        while self._clock.now_s() - last_s < SILENCE_S and self._clock.now_s() - start_s < LONGEST_DRAIN_S:
            if self._throw_away():
                last_s = self._clock.now_s()
            self._clock.sleep(0.002)
        self._port.is_using = False  # an exchange broken off by a signal leaves it set

    def close(self) -> None:
        """Give the port back."""
        try:
            self._port.closePort()
        except (SerialException, OSError, termios.error) as error:
            raise self._gone(error) from error

    def _throw_away(self) -> bool:
        try:
            waiting = bool(self._port.ser.in_waiting)
            if waiting:
                self._port.ser.reset_input_buffer()
        except (SerialException, OSError, termios.error) as error:
            raise self._gone(error) from error
        return waiting

    def _gone(self, error: Exception) -> LinkTimeoutError:
        return LinkTimeoutError(f"{self.name}: the port went away ({error}); check the USB cable")

    def _persistently(self, what: str, exchange: Callable[[], tuple[int, int, int]]) -> int:
        result = COMM_RX_TIMEOUT
        for _ in range(TRIES):
            try:
                answer, result, error = exchange()
                if result == COMM_SUCCESS:
                    self._raise_refusal(what, error & ~_ALERT)
                    return answer
                self.drain()
            except (SerialException, OSError, termios.error) as error:
                raise self._gone(error) from error
        if result in (COMM_RX_TIMEOUT, COMM_TX_FAIL):
            raise LinkTimeoutError(
                f"{self.name}: no answer to {what} after {TRIES} tries; check power, cable, id and baud rate"
            )
        raise GarbledReplyError(
            f"{self.name}: damaged answers to {what} ({self._packets.getTxRxResult(result)}); check cable"
        )

    def _raise_refusal(self, what: str, error: int) -> None:
        if error:
            raise DeviceError(f"{self.name}: {what}: {_STATUS_ERRORS.get(error, f'error {error}')}")
