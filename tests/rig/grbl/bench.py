"""Drivers and the simulated controller in one process, on one clock that nobody has to wait for."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from firmware_sim.grbl.config import GrblFaults
from firmware_sim.grbl.controller import GrblController as SimulatedController
from firmware_sim.grbl.dialect import DIALECTS, DialectName
from firmware_sim.grbl.settings import Settings, light_arm_settings
from firmware_sim.grbl.wire_faults import FaultyWire
from rig.config import ArmConfig, SpindleLampConfig
from rig.fakes import FakeClock
from rig.grbl.arm import GrblArm
from rig.grbl.config import StepperTurntableConfig
from rig.grbl.controller import GrblController
from rig.grbl.lamp import SpindleLamp
from rig.grbl.turntable import GrblTurntable

BAUD = 115_200
QUICK = {24: 3000.0, 25: 20_000.0, 120: 5000.0, 121: 5000.0, 122: 5000.0}
"""Homing in a second."""


@dataclass
class LoopPort:
    """Fits `rig.grbl.line.Port`; remembers what was written, and when."""

    wire: FaultyWire
    clock: FakeClock
    written: list[tuple[float, bytes]] = field(default_factory=list)
    unplugged: bool = False
    unplug_at_s: float = math.inf
    _said: bytes = b""
    _due: list[tuple[float, Callable[[], None]]] = field(default_factory=list)

    def read(self, size: int, /) -> bytes:
        """Let the simulator speak."""
        self._refuse_if_unplugged()
        said, self._said = self._said + self.wire.feed(b""), b""
        return said

    def write(self, content: bytes, /) -> int:
        """Let it hear; it answers at the next read."""
        self._refuse_if_unplugged()
        self.written.append((self.clock.time_s, content))
        self._said += self.wire.feed(content)
        return len(content)

    def close(self) -> None:
        """Nothing to give back."""

    def sent(self) -> bytes:
        """Return all that was written."""
        return b"".join(content for _, content in self.written)

    def at(self, time_s: float, happens: Callable[[], None]) -> None:
        """Let something happen when the driver next looks at the port after an instant."""
        self._due.append((time_s, happens))

    def _refuse_if_unplugged(self) -> None:
        for due in [due for due in self._due if due[0] <= self.clock.time_s]:
            self._due.remove(due)
            due[1]()
        if self.unplugged or self.clock.time_s >= self.unplug_at_s:
            raise OSError("[Errno 5] Input/output error")


class Bench:
    """A simulated controller, and drivers for it."""

    def __init__(
        self,
        *,
        dialect: DialectName = "grbl",
        settings: Settings | None = None,
        axes: int = 3,
        faults: GrblFaults | None = None,
        start: tuple[float, ...] = (-60.0, -35.0, -5.0, 0.0),
    ) -> None:
        self.clock = FakeClock(time_s=100.0)
        travel = (360.0, 90.0, 10.0, 0.0)[:axes]
        known = light_arm_settings(travel) | QUICK | (settings or {})
        self.sim = SimulatedController(lambda: self.clock.time_s, known, start[:axes], DIALECTS[dialect])
        self.wire = FaultyWire(self.sim, lambda: self.clock.time_s, faults)
        self.port = LoopPort(self.wire, self.clock)

    def controller(self) -> GrblController:
        """Open the driver's end."""
        return GrblController("a loop", BAUD, self.clock, self.port)

    def arm(self, controller: GrblController | None = None, **keys: object) -> GrblArm:
        """Open a light arm; `keys` as in RIG.toml."""
        config = ArmConfig.model_validate({"port": "a loop", **keys})
        return GrblArm(controller or self.controller(), config, self.clock)

    def lamp(self, controller: GrblController, **keys: object) -> SpindleLamp:
        """Open its lamp."""
        config = SpindleLampConfig.model_validate({"kind": "grbl-spindle", **keys})
        return SpindleLamp(controller, config, self.clock)

    def turntable(
        self, controller: GrblController | None = None, *, owns: bool = True, **keys: object
    ) -> GrblTurntable:
        """Open a turntable."""
        config = StepperTurntableConfig.model_validate({"kind": "grbl", "port": "a loop", **keys})
        return GrblTurntable(controller or self.controller(), config, self.clock, owns_controller=owns)

    def true_place(self) -> tuple[float, ...]:
        """Return where the axes truly are."""
        return self.sim.position(self.clock.time_s)
