"""The USB bus on a socket, for the pyusb backend of another process.

JSON lines as on the side channel. Each connection is a program of its own: what it has claimed is free when it ends.
"""

import socket
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from pydantic import Field, validate_call

from firmware_sim.side_channel import Answer, SideChannelServer
from firmware_sim.udmx.bus import BUS, UsbBus, UsbError
from firmware_sim.udmx.controller import Setup

Byte = Annotated[int, Field(ge=0, le=0xFF)]
Word = Annotated[int, Field(ge=0, le=0xFFFF)]
LONGEST_CONTENT = 4096


class UsbServer(SideChannelServer):
    """The requests of a backend: which devices there are, claiming one, and a control transfer."""

    def __init__(self, path: Path, bus: UsbBus) -> None:
        self._bus = bus
        self._speaker: socket.socket | None = None
        requests = (self._list, self._claim, self._release, self._control)
        super().__init__(path, {request.__name__.strip("_"): _with_errno(request) for request in requests})

    def serve(self, ready: socket.socket) -> None:
        """Take note of who asks."""
        self._speaker = ready
        super().serve(ready)

    def _drop(self, connection: socket.socket) -> None:
        self._bus.forget(connection)
        super()._drop(connection)

    def _list(self) -> Answer:
        devices = [
            {
                "bus": BUS,
                "address": plugged.address,
                "port": plugged.port,
                "device": plugged.controller.device_descriptor().hex(),
                "configuration": plugged.controller.configuration_descriptor().hex(),
            }
            for plugged in self._bus.present()
        ]
        return {"devices": devices}

    def _claim(self, address: int) -> Answer:
        self._bus.claim(address, self._speaker)
        return {}

    def _release(self, address: int) -> Answer:
        self._bus.release(address, self._speaker)
        return {}

    def _control(
        self,
        address: int,
        setup: tuple[Byte, Byte, Word, Word, Word],
        content: Annotated[str, Field(max_length=2 * LONGEST_CONTENT, pattern=r"^([0-9a-f]{2})*$")],
        timeout_s: float,
    ) -> Answer:
        reply = self._bus.control(address, Setup(*setup), bytes.fromhex(content), timeout_s)
        return {"carried": reply.carried, "content": reply.content.hex(), "takes_s": reply.takes_s}


def _with_errno(request: Callable[..., Answer]) -> Callable[..., Answer]:
    checked = validate_call(request)

    def answer(**parameters: object) -> Answer:
        try:
            return checked(**parameters)
        except UsbError as failure:
            return {"errno": failure.args[0]}

    return answer
