"""A uDMX on its USB socket: found by what it calls itself, opened for us alone, and anew when it drops off the bus."""

import errno
import struct
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import usb.core
import usb.util

from rig.clock import Clock
from rig.errors import DeviceError, LinkError, LinkTimeoutError, PortError
from rig.udmx import codec
from rig.udmx.backend import Backend
from rig.udmx.codec import Transfer
from rig.wire_record import current_recorder

VENDOR_ID, PRODUCT_ID = 0x16C0, 0x05DC
"""Shared by many hobby devices; the product string tells them apart."""
PRODUCT = "uDMX"
TIMEOUT_MS = 1000
TRIES = 3
REAPPEAR_S = 5.0
POLL_S = 0.05
STILL_THERE = (errno.EPIPE, errno.ETIMEDOUT)
"""A transfer that failed so is tried again; after any other failure the device is looked for anew."""

_SETUP = struct.Struct("<2B3H")
"""The eight bytes of a control transfer, as they stand in a wire record before its data."""

Device = Any
"""A `usb.core.Device`; pyusb ships no types."""


class UdmxLink:
    """The device, and what its slots are known to hold.

    Parameters
    ----------
    port : USB socket, bus-port; None if any uDMX will do
    backend : of pyusb; None for libusb
    clock : the time to wait by
    """

    def __init__(self, port: str | None, backend: Backend | None, clock: Clock) -> None:
        """Open it.

        Raises
        ------
        PortError
            There is none, or several, or it is taken or forbidden.
        """
        self._port, self._backend, self._clock = port, backend, clock
        self._recorder = current_recorder()
        self._known: list[int | None] = [None] * codec.SLOTS
        self._device: Device | None = None
        self._device = self._open()

    @property
    def name(self) -> str:
        """What errors call it."""
        return f"uDMX on USB socket {self._port}" if self._port else "uDMX"

    def show(self, wanted: Mapping[int, int]) -> None:
        """Bring slots to their values, and send no others.

        Raises
        ------
        DeviceError
            The device refused.
        LinkTimeoutError, PortError
            It does not answer, or did not come back, after every retry.
        """
        failure: Exception | None = None
        for _ in range(TRIES):
            try:
                if self._device is None:
                    self._device = self._reopen()
                for transfer in codec.changes(self._known, wanted):
                    self._send(self._device, transfer)
            except usb.core.USBError as error:
                failure = error
                if error.errno not in STILL_THERE:
                    self.close()
            else:
                return
        raise LinkTimeoutError(
            f"{self.name}: took no values in {TRIES} tries ({failure}); check its cable and plug it in again"
        ) from failure

    def close(self) -> None:
        """Give the device back, as its slots are; may be called twice."""
        if self._device is not None:
            with suppress(usb.core.USBError):  # it may have gone
                usb.util.dispose_resources(self._device)
        self._device = None
        self._known = [None] * codec.SLOTS

    def _send(self, device: Device, transfer: Transfer) -> None:
        # If the transfer breaks off, be it by a signal, nobody knows how far it came.
        for slot in transfer.slots:
            self._known[slot] = None
        if self._recorder is not None:
            setup = _SETUP.pack(
                codec.VENDOR_OUT, transfer.request, transfer.value, transfer.first, len(transfer.content)
            )
            self._recorder.note("out", self.name, setup + transfer.content)
        carried = device.ctrl_transfer(
            codec.VENDOR_OUT, transfer.request, transfer.value, transfer.first, transfer.content or None, TIMEOUT_MS
        )
        refusal = transfer.refusal(carried)
        if refusal:
            first, last = transfer.slots[0] + 1, transfer.slots[-1] + 1
            raise DeviceError(
                f"{self.name}: {refusal} to channels {first}..{last}; unplug it, plug it in again, and try once more"
            )
        for slot, value in zip(transfer.slots, transfer.values, strict=True):
            self._known[slot] = value

    def _reopen(self) -> Device:
        """Wait until the device is back on the bus."""
        deadline_s = self._clock.now_s() + REAPPEAR_S
        while True:
            try:
                return self._open()
            except LinkError as error:
                if self._clock.now_s() >= deadline_s:
                    raise PortError(f"{error} (it dropped off the bus, and was waited for {REAPPEAR_S:g} s)") from error
            self._clock.sleep(POLL_S)

    def _open(self) -> Device:
        device = self._find()
        try:
            usb.util.claim_interface(device, 0)
        except usb.core.USBError as error:
            usb.util.dispose_resources(device)
            raise self._cannot_open(error) from error
        return device

    def _find(self) -> Device:
        try:
            candidates = list(
                usb.core.find(find_all=True, backend=self._backend, idVendor=VENDOR_ID, idProduct=PRODUCT_ID)
            )
        except usb.core.NoBackendError as error:
            raise PortError(f"{self.name}: libusb is not installed; apt-get install libusb-1.0-0") from error
        except usb.core.USBError as error:
            raise self._cannot_open(error) from error
        products = {socket_of(device): _product(device) for device in candidates}
        found = [device for device in candidates if products[socket_of(device)] == PRODUCT]
        if self._port is not None:
            found = [device for device in found if socket_of(device) == self._port]
        for device in candidates:
            if device not in found or len(found) > 1:
                usb.util.dispose_resources(device)
        if len(found) == 1:
            return found[0]
        if found:
            sockets = ", ".join(map(socket_of, found))
            raise PortError(f"uDMX: {len(found)} are plugged in, on {sockets}; name one by port in RIG.toml's [lights]")
        if None in products.values():
            raise self._forbidden()
        others = "; ".join(f"{product!r} on {socket}" for socket, product in products.items())
        raise PortError(
            f"{self.name}: not on the USB bus{f', only {others}' if others else ''}; check its cable, and lsusb for "
            f"{VENDOR_ID:04x}:{PRODUCT_ID:04x}"
        )

    def _cannot_open(self, error: usb.core.USBError) -> PortError:
        if error.errno == errno.EBUSY:
            return PortError(f"{self.name}: held by another program; end it and try again")
        if error.errno == errno.EACCES:
            return self._forbidden()
        return PortError(f"{self.name}: cannot be opened ({error}); plug it in again")

    def _forbidden(self) -> PortError:
        return PortError(
            f"{self.name}: permission denied; a udev rule gives it to you: "
            f'SUBSYSTEM=="usb", ATTR{{idVendor}}=="{VENDOR_ID:04x}", ATTR{{idProduct}}=="{PRODUCT_ID:04x}", '
            'MODE="0660", TAG+="uaccess"'
        )


def socket_of(device: Device) -> str:
    """Return the USB socket that a device is plugged into, as the system names it."""
    ports = device.port_numbers
    return f"{device.bus}-{'.'.join(map(str, ports))}" if ports else f"{device.bus}-?{device.address}"


def _product(device: Device) -> str | None:
    """Return what a device calls itself, None if it does not say so to us."""
    try:
        return str(device.product)
    except (ValueError, usb.core.USBError):  # pyusb raises either where it may not ask
        return None
