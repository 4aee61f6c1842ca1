"""How the light arm on a GRBL controller is opened, and the lamp on that controller's spindle output."""

from rig.config import ArmConfig, SpindleLampConfig
from rig.devices import LightArm, Lights
from rig.drivers import Bench, Driver
from rig.errors import RigError
from rig.grbl.arm import GrblArm
from rig.grbl.controller import GrblController
from rig.grbl.lamp import SpindleLamp


def _controller(arm: ArmConfig, bench: Bench) -> GrblController:
    return bench.link(GrblController, arm.port, lambda: GrblController(arm.port, arm.baud, bench.clock))


def _open_arm(config: ArmConfig, bench: Bench) -> LightArm:
    return GrblArm(_controller(config, bench), config, bench.clock)


def _open_spindle_lamp(config: SpindleLampConfig, bench: Bench) -> Lights:
    if not isinstance(bench.config.arm, ArmConfig):
        raise RigError("lights of kind grbl-spindle: RIG.toml has no [arm] of kind grbl, whose output they are")
    return SpindleLamp(_controller(bench.config.arm, bench), config, bench.clock)


ARM = Driver(ArmConfig, _open_arm)
SPINDLE_LAMP = Driver(SpindleLampConfig, _open_spindle_lamp)
