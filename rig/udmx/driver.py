"""How lamps on a uDMX are opened."""

from rig.devices import Lights
from rig.drivers import Bench, Driver
from rig.errors import RigError
from rig.udmx.backend import load_backend
from rig.udmx.config import UdmxConfig
from rig.udmx.guard import Guard
from rig.udmx.lights import UdmxLights, levels
from rig.udmx.link import UdmxLink


def _open_lights(config: UdmxConfig, bench: Bench) -> Lights:
    if config.dome is not None:
        raise RigError(f"lights: the dome's file {config.dome} was not read; read RIG.toml by rig.config.read_rig")
    link = UdmxLink(config.port, load_backend(config.usb_backend, config.usb_address), bench.clock)
    try:
        guard = Guard(config.port, config.usb_backend, config.usb_address, levels(config, None))
    except BaseException:
        link.close()
        raise
    return UdmxLights(link, config, bench.clock, guard)


LIGHTS = Driver(UdmxConfig, _open_lights)
