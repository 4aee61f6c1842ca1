"""A backend for pyusb that reaches the simulated bus: a thin client of the simulator's process.

RIG.toml names `connect` and the socket; nothing else of pyusb or of a driver is replaced.
"""

import errno
import os
import select
import struct
from array import array
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Protocol

import usb.backend
import usb.core

from firmware_sim.child import Requests
from firmware_sim.errors import SideChannelError
from firmware_sim.side_channel import Answer, SideChannel

DEVICE_FIELDS = (
    *("bLength", "bDescriptorType", "bcdUSB", "bDeviceClass", "bDeviceSubClass", "bDeviceProtocol", "bMaxPacketSize0"),
    *("idVendor", "idProduct", "bcdDevice", "iManufacturer", "iProduct", "iSerialNumber", "bNumConfigurations"),
)
CONFIGURATION_FIELDS = (
    *("bLength", "bDescriptorType", "wTotalLength", "bNumInterfaces", "bConfigurationValue", "iConfiguration"),
    *("bmAttributes", "bMaxPower"),
)
INTERFACE_FIELDS = (
    *("bLength", "bDescriptorType", "bInterfaceNumber", "bAlternateSetting", "bNumEndpoints", "bInterfaceClass"),
    *("bInterfaceSubClass", "bInterfaceProtocol", "iInterface"),
)
LOW_SPEED = 1
GET_CONFIGURATION, SET_CONFIGURATION = 8, 9


class Channel(Requests, Protocol):
    """A program's way to the bus."""

    def close(self) -> None:
        """Hang up; the next request dials again."""


def connect(address: str) -> "SimulatedBackend":
    """Return the backend for the bus behind a socket."""
    return SimulatedBackend(SideChannel(Path(address)), _let_pass)


class SimulatedBackend(usb.backend.IBackend):  # type: ignore[misc]  # pyusb ships no types
    """What usb.core asks of libusb, as far as a device without endpoints needs it.

    Parameters
    ----------
    channel : carries the requests of `firmware_sim.udmx.usb_server`
    wait : lets the seconds pass that a transfer takes on a real wire
    """

    def __init__(self, channel: Channel, wait: Callable[[float], None]) -> None:
        super().__init__()
        self._channel, self._wait = channel, wait
        self._opened = 0

    def enumerate_devices(self) -> list[dict[str, Any]]:
        """Ask what is plugged in; what pyusb hands back to us later is an element of this."""
        devices: list[dict[str, Any]] = self._ask("present")["devices"]
        self._leave_if_nothing_is_open()
        return devices

    def get_device_descriptor(self, dev: dict[str, Any]) -> SimpleNamespace:
        values = struct.unpack("<BBHBBBBHHHBBBB", bytes.fromhex(dev["device"]))
        place = {"bus": dev["bus"], "address": dev["address"], "port_number": dev["port"], "speed": LOW_SPEED}
        described = dict(zip(DEVICE_FIELDS, values, strict=True))
        return SimpleNamespace(**described, **place, port_numbers=(dev["port"],))

    def get_configuration_descriptor(self, dev: dict[str, Any], config: int) -> SimpleNamespace:
        if config:
            raise IndexError("the device has one configuration")
        values = struct.unpack_from("<BBHBBBBB", bytes.fromhex(dev["configuration"]))
        return SimpleNamespace(**dict(zip(CONFIGURATION_FIELDS, values, strict=True)), extra_descriptors=[])

    def get_interface_descriptor(self, dev: dict[str, Any], intf: int, alt: int, config: int) -> SimpleNamespace:
        if intf or alt or config:
            raise IndexError("the device has one interface")
        values = struct.unpack_from("<BBBBBBBBB", bytes.fromhex(dev["configuration"]), 9)
        return SimpleNamespace(**dict(zip(INTERFACE_FIELDS, values, strict=True)), extra_descriptors=[])

    def get_endpoint_descriptor(self, dev: dict[str, Any], ep: int, intf: int, alt: int, config: int) -> None:
        raise IndexError("the device has no endpoint beside 0")

    def open_device(self, dev: dict[str, Any]) -> int:
        address: int = dev["address"]
        if all(other["address"] != address for other in self.enumerate_devices()):
            raise _error(errno.ENODEV)
        self._opened += 1
        return address

    def close_device(self, dev_handle: int) -> None:
        """Give it back; what was claimed is free when nothing is open any more."""
        self._opened -= 1
        self._leave_if_nothing_is_open()

    def set_configuration(self, dev_handle: int, config_value: int) -> None:
        self.ctrl_transfer(dev_handle, 0x00, SET_CONFIGURATION, config_value, 0, array("B"), 1000)

    def get_configuration(self, dev_handle: int) -> int:
        content = array("B", bytes(1))
        self.ctrl_transfer(dev_handle, 0x80, GET_CONFIGURATION, 0, 0, content, 1000)
        return content[0]

    def claim_interface(self, dev_handle: int, intf: int) -> None:
        self._ask("claim", address=dev_handle)

    def release_interface(self, dev_handle: int, intf: int) -> None:
        self._ask("release", address=dev_handle)

    def is_kernel_driver_active(self, dev_handle: int, intf: int) -> bool:
        return False

    def ctrl_transfer(
        self,
        dev_handle: int,
        bmRequestType: int,  # noqa: N803  # pyusb's name
        bRequest: int,  # noqa: N803
        wValue: int,  # noqa: N803
        wIndex: int,  # noqa: N803
        data: "array[int]",
        timeout: int,
    ) -> int:
        """Carry a transfer over, and let the time pass that it takes on a real wire."""
        reads = bool(bmRequestType & 0x80)
        setup = (bmRequestType, bRequest, wValue, wIndex, len(data))
        content = "" if reads else data.tobytes().hex()
        answer = self._ask("control", address=dev_handle, setup=setup, content=content, timeout_s=timeout / 1000)
        self._wait(answer["takes_s"])
        if reads:
            received = bytes.fromhex(answer["content"])
            data[: len(received)] = array("B", received)
        carried: int = answer["carried"]
        return carried

    def _leave_if_nothing_is_open(self) -> None:
        if not self._opened:
            self._channel.close()

    def _ask(self, do: str, **parameters: object) -> Answer:
        try:
            answer = self._channel.request(do, **parameters)
        except SideChannelError as error:  # the whole bus has gone
            raise _error(errno.ENODEV) from error
        except BaseException:  # a signal broke in: the answer that is still to come must not be taken for the next
            self._channel.close()
            raise
        if "errno" in answer:
            raise _error(answer["errno"])
        return answer


def _let_pass(seconds: float) -> None:
    select.select([], [], [], seconds)


def _error(number: int) -> Exception:
    kind = usb.core.USBTimeoutError if number == errno.ETIMEDOUT else usb.core.USBError
    error: Exception = kind(os.strerror(number), None, number)
    return error
