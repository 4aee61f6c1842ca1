"""The USB bus on a socket, for the pyusb backend of another process.

JSON lines as on the side channel. Each connection is a program of its own: what it has claimed is free when it ends.
"""

import socket
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Annotated

from pydantic import Field, validate_call

from firmware_sim.side_channel import Answer, Handler, SideChannelServer
from firmware_sim.udmx.bus import BUS, UsbBus, UsbError
from firmware_sim.udmx.controller import Setup

Byte = Annotated[int, Field(ge=0, le=0xFF)]
Word = Annotated[int, Field(ge=0, le=0xFFFF)]
LONGEST_CONTENT = 4096


class UsbServer(SideChannelServer):
    """The bus on a socket."""

    def __init__(self, path: Path, bus: UsbBus) -> None:
        self._bus = bus
        self._speaker: socket.socket | None = None
        super().__init__(path, usb_requests(bus, lambda: self._speaker))

    def serve(self, ready: socket.socket) -> None:
        """Take note of who asks."""
        self._speaker = ready
        super().serve(ready)

    def _drop(self, connection: socket.socket) -> None:
        self._bus.forget(connection)
        super()._drop(connection)


def usb_requests(bus: UsbBus, speaker: Callable[[], Hashable]) -> dict[str, Handler]:
    """Return the requests of a backend: which devices there are, claiming one, and a control transfer.

    Parameters
    ----------
    bus : what they act on
    speaker : gives the program that is asking
    """

    @validate_call
    def present() -> Answer:
        devices = [
            {
                "bus": BUS,
                "address": plugged.address,
                "port": plugged.port,
                "device": plugged.controller.device_descriptor().hex(),
                "configuration": plugged.controller.configuration_descriptor().hex(),
            }
            for plugged in bus.present()
        ]
        return {"devices": devices}

    @validate_call
    def claim(address: int) -> Answer:
        bus.claim(address, speaker())
        return {}

    @validate_call
    def release(address: int) -> Answer:
        bus.release(address, speaker())
        return {}

    @validate_call
    def control(
        address: int,
        setup: tuple[Byte, Byte, Word, Word, Word],
        content: Annotated[str, Field(max_length=2 * LONGEST_CONTENT, pattern=r"^([0-9a-f]{2})*$")],
        timeout_s: float,
    ) -> Answer:
        reply = bus.control(address, Setup(*setup), bytes.fromhex(content), timeout_s)
        return {"carried": reply.carried, "content": reply.content.hex(), "takes_s": reply.takes_s}

    return {request.__name__: _with_errno(request) for request in (present, claim, release, control)}


def _with_errno(request: Handler) -> Handler:
    def answer(**parameters: object) -> Answer:
        try:
            return request(**parameters)
        except UsbError as failure:
            return {"errno": failure.args[0]}

    return answer
