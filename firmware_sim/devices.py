"""The devices of one rig: servo bus, light arm, lamps on USB, and where they are at any instant."""

from firmware_sim.clock import Clock
from firmware_sim.config import SimConfig
from firmware_sim.dynamixel.bus import DynamixelBus
from firmware_sim.dynamixel.control_table import BAUDS, Register
from firmware_sim.dynamixel.servo import Servo
from firmware_sim.grbl.bench import GrblBench
from firmware_sim.scene.pose import LitLamp
from firmware_sim.udmx.bus import UsbBus
from firmware_sim.udmx.dome import Dome


class Devices:
    """State machines, set up as SIM.toml says."""

    def __init__(self, config: SimConfig, clock: Clock) -> None:
        table = config.turntable
        self.servo = Servo(clock, table.id, table.start_deg)
        self.servo.memory[Register.BAUD_RATE] = next(code for code, baud in BAUDS.items() if baud == table.baud)
        self.bus = DynamixelBus(clock, [self.servo])
        self.grbl = GrblBench(config, clock)
        self.arm = self.grbl.arm.controller
        self.usb = UsbBus(clock, config.dome)
        self.dome = None if config.dome is None else Dome(config.dome)

    def pose(self, time_s: float) -> tuple[float, float, float, float]:
        """Return turntable angle, azimuth and elevation in degrees, and lamp 0..1, at any time of the last seconds."""
        azimuth_deg, elevation_deg = self.grbl.directions_deg(time_s)
        stepper_deg = self.grbl.table_deg(time_s)
        turntable_deg = self.servo.angle_deg(time_s) if stepper_deg is None else stepper_deg
        return turntable_deg, azimuth_deg, elevation_deg, self.arm.lamp.power_at(time_s)

    def turntable_is_moving(self) -> bool:
        """Tell whether servo or stepper turns."""
        moving = self.grbl.table_is_moving()
        return self.servo.is_turning() if moving is None else moving

    def shining(self, time_s: float) -> tuple[LitLamp, ...]:
        """Return the dome's lamps that shine, at any time of the last seconds."""
        return () if self.dome is None else self.dome.lit(self.usb.lamps.controller.dimmers.slots_at(time_s))
