"""The devices of a rig, as a session's records name them."""

import os

from serial.tools import list_ports

from rig.config import RigConfig


def instruments(config: RigConfig) -> tuple[str, ...]:
    """Name each part with its serial number: as RIG.toml has it, else that of the USB adapter that it hangs on."""
    adapters = {os.path.realpath(port.device): port.serial_number for port in list_ports.comports()}
    named = []
    for section in (config.turntable, config.arm, config.lights, config.camera):
        if section is None or not section.instrument:
            continue
        on_usb = adapters.get(os.path.realpath(getattr(section, "port", "")))
        if section.serial_number:
            named.append(f"{section.instrument}, serial number {section.serial_number}")
        elif on_usb:
            named.append(f"{section.instrument}, on USB adapter {on_usb}")
        else:
            named.append(section.instrument)
    return tuple(named)
