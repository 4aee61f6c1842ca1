"""The uDMX's firmware: what it answers to each control transfer on its endpoint 0."""

import struct
from enum import IntEnum
from typing import NamedTuple

from firmware_sim.clock import Clock
from firmware_sim.udmx.config import MOST_SLOTS
from firmware_sim.udmx.dimmers import Dimmers

VENDOR_ID, PRODUCT_ID = 0x16C0, 0x05DC
MANUFACTURER = "www.anyma.ch"
ENGLISH_US = 0x0409
STRINGS_FROM = 1
STANDARD, VENDOR = 0, 2
DEVICE_DESCRIPTOR, CONFIGURATION_DESCRIPTOR, STRING_DESCRIPTOR = 1, 2, 3
START_BOOTLOADER = (0xF8, 0x32)
BAD_CHANNEL, BAD_VALUE = 1, 2


class Standard(IntEnum):
    """Requests that every USB device answers."""

    GET_STATUS = 0
    GET_DESCRIPTOR = 6
    GET_CONFIGURATION = 8
    SET_CONFIGURATION = 9
    GET_INTERFACE = 10


class Vendor(IntEnum):
    """The firmware's own."""

    SET_SINGLE_CHANNEL = 1
    SET_CHANNEL_RANGE = 2


class Setup(NamedTuple):
    """The eight bytes that begin a control transfer."""

    request_type: int
    request: int
    w_value: int
    w_index: int
    w_length: int

    @property
    def kind(self) -> int:
        """Standard, class or vendor."""
        return self.request_type >> 5 & 3

    @property
    def reads(self) -> bool:
        return bool(self.request_type & 0x80)

    def packed(self) -> bytes:
        return struct.pack("<BBHHH", *self)


class Controller:
    """One device. Its answer to an OUT transfer is nothing; a single byte where it refuses."""

    def __init__(self, clock: Clock, product: str = "uDMX") -> None:
        self._clock = clock
        self._configuration = 0
        self.product = product
        self.dimmers = Dimmers(clock())
        self.in_bootloader = False

    def power_up(self) -> None:
        """Begin anew, as after a drop of the supply."""
        self._configuration = 0
        self.dimmers.darken(self._clock())

    def control(self, setup: Setup, content: bytes, now_s: float) -> bytes:
        """Carry out a transfer that ends at an instant; returns the device's answer."""
        if setup.kind == STANDARD:
            return self._standard(setup)[: setup.w_length]
        if setup.kind != VENDOR:
            return b""
        match setup.request:
            case Vendor.SET_SINGLE_CHANNEL:
                return self._set_single(setup, now_s)
            case Vendor.SET_CHANNEL_RANGE:
                return self._set_range(setup, content, now_s)
            case request if request in START_BOOTLOADER:
                self.in_bootloader = True
                self.product = "USBasp"
        return b""

    def device_descriptor(self) -> bytes:
        fields = (18, DEVICE_DESCRIPTOR, 0x0110, 0xFF, 0, 0, 8, VENDOR_ID, PRODUCT_ID, 0x0102, 1, 2, 0, 1)
        return struct.pack("<BBHBBBBHHHBBBB", *fields)

    def configuration_descriptor(self) -> bytes:
        """One interface without endpoints of its own."""
        interface = struct.pack("<BBBBBBBBB", 9, 4, 0, 0, 0, 0, 0, 0, 0)
        return struct.pack("<BBHBBBBB", 9, CONFIGURATION_DESCRIPTOR, 9 + len(interface), 1, 1, 0, 0x80, 50) + interface

    def _standard(self, setup: Setup) -> bytes:
        match setup.request:
            case Standard.GET_STATUS:
                return bytes(2)
            case Standard.GET_DESCRIPTOR:
                return self._descriptor(setup.w_value >> 8, setup.w_value & 0xFF)
            case Standard.GET_CONFIGURATION:
                return bytes([self._configuration])
            case Standard.SET_CONFIGURATION:
                self._configuration = setup.w_value & 0xFF
            case Standard.GET_INTERFACE:
                return bytes(1)
        return b""

    def _descriptor(self, kind: int, number: int) -> bytes:
        if kind == DEVICE_DESCRIPTOR:
            return self.device_descriptor()
        if kind == CONFIGURATION_DESCRIPTOR:
            return self.configuration_descriptor()
        strings = (MANUFACTURER, self.product)
        if kind == STRING_DESCRIPTOR and number == 0:
            return struct.pack("<BBH", 4, STRING_DESCRIPTOR, ENGLISH_US)
        if kind == STRING_DESCRIPTOR and number <= len(strings):
            text = strings[number - STRINGS_FROM].encode("utf-16-le")
            return bytes([2 + len(text), STRING_DESCRIPTOR]) + text
        return b""

    def _set_single(self, setup: Setup, now_s: float) -> bytes:
        if setup.w_index >= MOST_SLOTS:
            return bytes([BAD_CHANNEL])
        if setup.w_value > 255:
            return bytes([BAD_VALUE])
        self.dimmers.set(setup.w_index, bytes([setup.w_value]), now_s)
        return b""

    def _set_range(self, setup: Setup, content: bytes, now_s: float) -> bytes:
        if setup.w_index >= MOST_SLOTS:
            return bytes([BAD_CHANNEL])
        if not 1 <= setup.w_value <= MOST_SLOTS - setup.w_index or len(content) < setup.w_value:
            return bytes([BAD_VALUE])
        self.dimmers.set(setup.w_index, content[: setup.w_value], now_s)
        return b""
