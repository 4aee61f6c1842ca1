"""The GRBL controllers of one rig: the arm's, and perhaps one for a stepper turntable."""

from firmware_sim.clock import Clock
from firmware_sim.config import SimConfig
from firmware_sim.grbl.controller import GrblController
from firmware_sim.grbl.dialect import DIALECTS
from firmware_sim.grbl.settings import AXES, light_arm_settings
from firmware_sim.grbl.stepper import angle_deg, own_settings, shared_settings, start_position
from firmware_sim.grbl.wire_faults import FaultyWire

Z_TRAVEL = 10.0
"""The third axis has no motor on a light arm; the controller homes it all the same."""


class GrblBench:
    """Controllers behind their wires, set up as SIM.toml says.

    Attributes
    ----------
    arm, table : wires with a controller behind; `table` is None unless a stepper table has a controller of its own
    """

    def __init__(self, config: SimConfig, clock: Clock) -> None:
        self._config = config
        arm, stepper = config.arm, config.stepper
        self._travel = (arm.azimuth_travel_deg, arm.elevation_travel_deg)
        shared = stepper if stepper is not None and stepper.on_the_arm else None
        count = 3 if shared is None else max(3, AXES.index(shared.axis) + 1)
        self._arm_settings = light_arm_settings((*self._travel, *[Z_TRAVEL, 0.0, 0.0, 0.0][: count - 2]))
        start = [arm.start_azimuth_deg - self._travel[0], arm.start_elevation_deg - self._travel[1], -Z_TRAVEL / 2]
        start += [0.0] * (count - 3)
        if shared is not None:
            self._arm_settings |= shared_settings(shared)
            start[AXES.index(shared.axis)] = start_position(shared, self._arm_settings)
        self._arm_settings |= {number: value for number, value in arm.settings.items() if number in self._arm_settings}
        controller = GrblController(clock, self._arm_settings, tuple(start), DIALECTS[arm.dialect])
        self.arm = FaultyWire(controller, clock, arm.faults)
        self.table = None if stepper is None or stepper.on_the_arm else self._own(clock)
        for wire, faults in ((self.arm, arm.faults), (self.table, None if stepper is None else stepper.faults)):
            if wire is not None and faults is not None and faults.switches != "none":
                wire.controller.break_switches(faults.switches)

    def directions_deg(self, time_s: float) -> tuple[float, float]:
        """Return azimuth and elevation of the arm, at any time of the last seconds."""
        x, y, *_ = self.arm.controller.position(time_s)
        return x + self._travel[0], y + self._travel[1]

    def table_deg(self, time_s: float) -> float | None:
        """Return the angle of the stepper table; None if there is none."""
        stepper = self._config.stepper
        if stepper is None:
            return None
        wire, settings = (self.arm, self._arm_settings) if self.table is None else (self.table, self._own_settings)
        position = wire.controller.position(time_s)[AXES.index(stepper.axis)]
        return angle_deg(position, stepper, settings)

    def table_is_moving(self) -> bool | None:
        """Tell whether the stepper table's controller moves something; None if there is none."""
        if self._config.stepper is None:
            return None
        return (self.table or self.arm).controller.is_moving

    def _own(self, clock: Clock) -> FaultyWire:
        stepper = self._config.stepper
        if stepper is None:
            raise AssertionError("called for a stepper only")
        self._own_settings = own_settings(stepper)
        axis = AXES.index(stepper.axis)
        start = [0.0] * max(3, axis + 1)
        start[axis] = start_position(stepper, self._own_settings)
        controller = GrblController(clock, self._own_settings, tuple(start), DIALECTS[stepper.dialect])
        return FaultyWire(controller, clock, stepper.faults)
