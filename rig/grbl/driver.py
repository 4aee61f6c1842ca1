"""How what hangs on a GRBL controller is opened: light arm, turntable, and the lamp on the arm's controller."""

from collections.abc import Mapping

from rig.config import ArmConfig, SpindleLampConfig
from rig.devices import LightArm, Lights, Turntable
from rig.drivers import Bench, Driver
from rig.errors import RigError
from rig.grbl.arm import GrblArm
from rig.grbl.config import StepperTurntableConfig
from rig.grbl.controller import GrblController
from rig.grbl.lamp import SpindleLamp
from rig.grbl.settings import ensure_settings
from rig.grbl.turntable import GrblTurntable

NO_SETTINGS: Mapping[int, float] = {}


def _controller(port: str, baud: int, bench: Bench, settings: Mapping[int, float] = NO_SETTINGS) -> GrblController:
    controller = bench.link(GrblController, port, lambda: GrblController(port, baud, bench.clock))
    ensure_settings(controller, settings)
    return controller


def _open_arm(config: ArmConfig, bench: Bench) -> LightArm:
    return GrblArm(_controller(config.port, config.baud, bench, config.settings), config, bench.clock)


def _open_turntable(config: StepperTurntableConfig, bench: Bench) -> Turntable:
    arm = bench.config.arm
    is_shared = isinstance(arm, ArmConfig) and arm.port == config.port
    if is_shared and config.axis in ("X", "Y"):
        raise RigError(f"turntable: axis {config.axis} is one of the arm's; the table's is Z, A, B or C")
    controller = _controller(config.port, config.baud, bench, config.settings)
    return GrblTurntable(controller, config, bench.clock, owns_controller=not is_shared)


def _open_spindle_lamp(config: SpindleLampConfig, bench: Bench) -> Lights:
    arm = bench.config.arm
    if not isinstance(arm, ArmConfig):
        raise RigError("lights of kind grbl-spindle: RIG.toml has no [arm] of kind grbl, whose output they are")
    return SpindleLamp(_controller(arm.port, arm.baud, bench, arm.settings), config, bench.clock)


ARM = Driver(ArmConfig, _open_arm)
TURNTABLE = Driver(StepperTurntableConfig, _open_turntable)
SPINDLE_LAMP = Driver(SpindleLampConfig, _open_spindle_lamp)
