"""The [lights] of RIG.toml for a simulated dome."""

from firmware_sim.udmx.bus import BUS, CONTROLLER_PORT
from firmware_sim.udmx.config import DomeSim
from firmware_sim.udmx.dome import brightness, direction_deg


def dome_toml(config: DomeSim, usb_address: str) -> str:
    """Describe the dome as somebody would who measured it: directions, and gains that make all lamps equal."""
    darkest = min(brightness(config, lamp) for lamp in range(config.lamps))
    lamps = []
    for lamp in range(config.lamps):
        azimuth_deg, elevation_deg = direction_deg(config, lamp)
        lamps.append(
            "[[lights.lamp]]\n"
            f"channels = [{1 + lamp * config.slots_a_lamp}]\n"
            f"azimuth_deg = {azimuth_deg:.3f}\n"
            f"elevation_deg = {elevation_deg:.3f}\n"
            f"gain = {darkest / brightness(config, lamp):.4f}\n"
        )
    return f"""\
[lights]
kind = "udmx"
port = "{BUS}-{CONTROLLER_PORT}"
sixteen_bit = {str(config.sixteen_bit).lower()}
usb_backend = "firmware_sim.udmx.backend:connect"
usb_address = "{usb_address}"

""" + "\n".join(lamps)
