"""A uDMX and its lamps in this process: the real pyusb on the simulated bus, and a clock that costs no time."""

from dataclasses import dataclass, field

from firmware_sim.side_channel import Answer
from firmware_sim.udmx.backend import SimulatedBackend
from firmware_sim.udmx.bus import UsbBus
from firmware_sim.udmx.config import DomeSim
from firmware_sim.udmx.controller import START_BOOTLOADER
from firmware_sim.udmx.dome import Dome
from firmware_sim.udmx.faults import lights_faults
from firmware_sim.udmx.usb_server import usb_requests
from rig.fakes import FakeClock
from rig.udmx.link import UdmxLink

LONG_S = 0.1


@dataclass
class Program:
    """One program on the bus; fits `firmware_sim.udmx.backend.Channel`."""

    bus: UsbBus

    def request(self, do: str, **parameters: object) -> Answer:
        return usb_requests(self.bus, lambda: id(self))[do](**parameters)

    def close(self) -> None:
        self.bus.forget(id(self))


@dataclass
class LampBench:
    """The bus, and programs on it."""

    config: DomeSim = field(default_factory=DomeSim)
    clock: FakeClock = field(default_factory=FakeClock)

    def __post_init__(self) -> None:
        self.bus = UsbBus(self.clock.now_s, self.config)
        self.dome = Dome(self.config)
        self.faults = lights_faults(self.bus, self.dome)

    def backend(self) -> SimulatedBackend:
        return SimulatedBackend(Program(self.bus), self.clock.sleep)

    def link(self, port: str | None = "1-1") -> UdmxLink:
        return UdmxLink(port, self.backend(), self.clock)

    def slots(self) -> bytes:
        """Return what the dimmers have after a while."""
        self.clock.sleep(LONG_S)
        return self.bus.lamps.controller.dimmers.slots_at(self.clock.now_s())

    def heard(self) -> list[tuple[int, int, int, str]]:
        """Return the vendor's transfers that came over the wire: request, value, index, data in hexadecimal."""
        transfers = [bytes.fromhex(content) for _, way, content in self.bus.lamps.log if way == "in"]
        vendors = [transfer for transfer in transfers if transfer[0] >> 5 & 3 == 2]
        assert not any(transfer[1] in START_BOOTLOADER for transfer in vendors)
        return [
            (told[1], int.from_bytes(told[2:4], "little"), int.from_bytes(told[4:6], "little"), told[8:].hex())
            for told in vendors
        ]
