"""The USB bus: which devices are on it, who has opened them, and what goes wrong on the way."""

import errno
from collections import deque
from collections.abc import Hashable
from dataclasses import dataclass, field

from firmware_sim.clock import Clock
from firmware_sim.udmx.config import DomeSim
from firmware_sim.udmx.controller import Controller, Setup

BUS = 1
CONTROLLER_PORT, NEIGHBOUR_PORT = 1, 2
TRANSFER_S = 0.001
"""What a transfer takes without data."""
SLOT_S = (0.035 - TRANSFER_S) / 512
"""What a byte of data takes besides: 512 of them 35 ms in all."""
LOG_LENGTH = 200


class UsbError(Exception):
    """What the kernel answers in place of the device: its argument is the errno."""


@dataclass
class Reply:
    """How a transfer ended.

    Attributes
    ----------
    carried : bytes that the data stage carried
    content : what was read
    takes_s : how long the wire was busy
    """

    carried: int
    content: bytes
    takes_s: float


@dataclass
class Plugged:
    """A device in a socket of the hub."""

    controller: Controller
    port: int
    address: int
    back_s: float = 0.0
    unplugged: bool = False
    owner: Hashable | None = None
    log: deque[tuple[float, str, str]] = field(default_factory=lambda: deque(maxlen=LOG_LENGTH))

    def as_status(self) -> dict[str, object]:
        """Return what the side channel tells: slots on their way to the dimmers, and the last transfers.

        A transfer is CLOCK_MONOTONIC in seconds, "in" or "out", and its bytes in hexadecimal, setup first.
        """
        controller = self.controller
        return {
            "port": f"{BUS}-{self.port}",
            "product": controller.product,
            "in_bootloader": controller.in_bootloader,
            "slots": controller.dimmers.slots.hex(),
            "recent": list(self.log),
        }


@dataclass
class Mishaps:
    """What waits for the next transfers of the controller: how many of each, and how many to let through before."""

    after: int = 0
    stalls: int = 0
    refusals: int = 0
    code: int = 0
    drop_outs: int = 0
    away_s: float = 0.0
    forgets: bool = True


class UsbBus:
    """A hub with the lamps' controller, and perhaps another device of the same numbers.

    Parameters
    ----------
    clock : seconds
    config : of the dome, None if nothing is plugged in
    """

    def __init__(self, clock: Clock, config: DomeSim | None) -> None:
        self._clock = clock
        self._config = config
        self._addresses = 1
        self._transfers = 0
        self._busy_until_s = 0.0
        self.mishaps = Mishaps()
        self.devices: list[Plugged] = []
        if config is not None:
            self._plug(Controller(clock, config.product), CONTROLLER_PORT)
            if config.neighbour != "none":
                product = "uDMX" if config.neighbour == "udmx" else "Thermometer"
                self._plug(Controller(clock, product), NEIGHBOUR_PORT)

    def _plug(self, controller: Controller, port: int) -> None:
        self._addresses += 1
        self.devices.append(Plugged(controller, port, self._addresses))

    @property
    def lamps(self) -> Plugged:
        """The controller of the dome."""
        return self.devices[0]

    def present(self) -> list[Plugged]:
        """Return what is on the bus now."""
        now_s = self._clock()
        return [plugged for plugged in self.devices if now_s >= plugged.back_s and not plugged.unplugged]

    def claim(self, address: int, owner: Hashable) -> None:
        """Give a device to one program alone."""
        plugged = self._at(address)
        if plugged.owner not in (None, owner):
            raise UsbError(errno.EBUSY)
        plugged.owner = owner

    def release(self, address: int, owner: Hashable) -> None:
        """Take it back."""
        plugged = self._at(address)
        if plugged.owner == owner:
            plugged.owner = None

    def forget(self, owner: Hashable) -> None:
        """Take back whatever a program had that has ended."""
        for plugged in self.devices:
            if plugged.owner == owner:
                plugged.owner = None

    def leave(self, plugged: Plugged, away_s: float, *, forgets: bool) -> None:
        """Let a device drop off the bus; it comes back under another address."""
        plugged.back_s = self._clock() + away_s
        plugged.owner = None
        self._addresses += 1
        plugged.address = self._addresses
        if forgets:
            plugged.controller.power_up()

    def control(self, address: int, setup: Setup, content: bytes, timeout_s: float) -> Reply:
        """Carry out a control transfer.

        Raises
        ------
        UsbError
            The device is not there, stalls, or takes longer than the host waits.
        """
        plugged = self._at(address)
        takes_s = TRANSFER_S + SLOT_S * (len(content) if not setup.reads else 0)
        start_s = max(self._clock(), self._busy_until_s)
        self._busy_until_s = start_s + takes_s
        plugged.log.append((self._clock(), "in", (setup.packed() + content).hex()))
        if takes_s > timeout_s > 0:
            raise UsbError(errno.ETIMEDOUT)
        refusal = self._befall(plugged, setup, content) if plugged is self.lamps and setup.kind == 2 else b""
        answer = refusal or plugged.controller.control(setup, content, start_s + takes_s)
        if answer:
            plugged.log.append((self._clock(), "out", answer.hex()))
        if setup.reads:
            return Reply(len(answer), answer, takes_s)
        return Reply(len(answer) or len(content), b"", takes_s)

    def _befall(self, plugged: Plugged, setup: Setup, content: bytes) -> bytes:
        """Let happen what was asked for; returns the error byte if the device is to refuse."""
        self._transfers += 1
        if self._config is not None:
            if self._config.drop_out_every and self._transfers % self._config.drop_out_every == 0:
                self._drop_out(plugged, setup, content, self._config.drop_out_s, forgets=self._config.drop_out_forgets)
            if self._config.stall_every and self._transfers % self._config.stall_every == 0:
                raise UsbError(errno.EPIPE)
        waiting = self.mishaps
        if waiting.after:
            waiting.after -= 1
        elif waiting.stalls:
            waiting.stalls -= 1
            raise UsbError(errno.EPIPE)
        elif waiting.refusals:
            waiting.refusals -= 1
            return bytes([waiting.code])
        elif waiting.drop_outs:
            waiting.drop_outs -= 1
            self._drop_out(plugged, setup, content, waiting.away_s, forgets=waiting.forgets)
        return b""

    def _drop_out(self, plugged: Plugged, setup: Setup, content: bytes, away_s: float, *, forgets: bool) -> None:
        """Leave in the middle of a range, or before a single value."""
        half = len(content) // 2
        if half:
            plugged.controller.control(setup._replace(w_value=half), content[:half], self._clock())
        self.leave(plugged, away_s, forgets=forgets)
        raise UsbError(errno.ENODEV)

    def _at(self, address: int) -> Plugged:
        for plugged in self.present():
            if plugged.address == address:
                return plugged
        raise UsbError(errno.ENODEV)
