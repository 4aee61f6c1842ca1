"""How the turntable on a Dynamixel servo is opened."""

from rig.config import TurntableConfig
from rig.devices import Turntable
from rig.drivers import Bench, Driver
from rig.dynamixel.link import DynamixelLink
from rig.dynamixel.turntable import DynamixelTurntable


def _open_turntable(config: TurntableConfig, bench: Bench) -> Turntable:
    link = DynamixelLink(config.port, config.baud, config.id, bench.clock)
    return DynamixelTurntable(link, config, bench.clock)


TURNTABLE = Driver(TurntableConfig, _open_turntable)
