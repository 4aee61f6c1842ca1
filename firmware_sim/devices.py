"""The devices of one rig: servo bus, light arm, lamps on USB, and where they are at any instant."""

from firmware_sim.clock import Clock
from firmware_sim.config import SimConfig
from firmware_sim.dynamixel.bus import DynamixelBus
from firmware_sim.dynamixel.control_table import BAUDS, Register
from firmware_sim.dynamixel.servo import Servo
from firmware_sim.grbl.controller import GrblController
from firmware_sim.grbl.settings import light_arm_settings
from firmware_sim.scene.pose import LitLamp
from firmware_sim.udmx.bus import UsbBus
from firmware_sim.udmx.dome import Dome

Z_TRAVEL = 10.0
"""The third axis has no motor on a light arm; the controller homes it all the same."""


class Devices:
    """State machines, set up as SIM.toml says."""

    def __init__(self, config: SimConfig, clock: Clock) -> None:
        table, arm = config.turntable, config.arm
        self.servo = Servo(clock, table.id, table.start_deg)
        self.servo.memory[Register.BAUD_RATE] = next(code for code, baud in BAUDS.items() if baud == table.baud)
        self.bus = DynamixelBus(clock, [self.servo])
        self._travel = (arm.azimuth_travel_deg, arm.elevation_travel_deg)
        start = (arm.start_azimuth_deg - self._travel[0], arm.start_elevation_deg - self._travel[1], -Z_TRAVEL / 2)
        self.arm = GrblController(clock, light_arm_settings((*self._travel, Z_TRAVEL)), start)
        self.usb = UsbBus(clock, config.dome)
        self.dome = None if config.dome is None else Dome(config.dome)

    def pose(self, time_s: float) -> tuple[float, float, float, float]:
        """Return turntable angle, azimuth and elevation in degrees, and lamp 0..1, at any time of the last seconds."""
        x, y, _ = self.arm.position(time_s)
        azimuth_deg, elevation_deg = x + self._travel[0], y + self._travel[1]
        return self.servo.angle_deg(time_s), azimuth_deg, elevation_deg, self.arm.lamp.power_at(time_s)

    def shining(self, time_s: float) -> tuple[LitLamp, ...]:
        """Return the dome's lamps that shine, at any time of the last seconds."""
        return () if self.dome is None else self.dome.lit(self.usb.lamps.controller.dimmers.slots_at(time_s))
