"""The devices of one rig: servo bus, light arm, and where they are at any instant."""

from firmware_sim.clock import Clock
from firmware_sim.config import SimConfig
from firmware_sim.dynamixel.bus import DynamixelBus
from firmware_sim.dynamixel.config import TurntableFaults
from firmware_sim.dynamixel.control_table import BAUDS, Register
from firmware_sim.dynamixel.servo import Servo
from firmware_sim.dynamixel.table import Table
from firmware_sim.grbl.controller import GrblController
from firmware_sim.grbl.settings import light_arm_settings

Z_TRAVEL = 10.0
"""The third axis has no motor on a light arm; the controller homes it all the same."""


class Devices:
    """State machines, set up as SIM.toml says."""

    def __init__(self, config: SimConfig, clock: Clock) -> None:
        table, arm = config.turntable, config.arm
        self.servo = Servo(clock, table.id, table.start_deg)
        others = [Servo(clock, servo_id, 0.0) for servo_id in table.others]
        self.bus = DynamixelBus(clock, [self.servo, *others])
        self.table = Table(self.servo, clock)
        self.listen_at(table.baud)
        self._befall(table.faults)
        self._travel = (arm.azimuth_travel_deg, arm.elevation_travel_deg)
        start = (arm.start_azimuth_deg - self._travel[0], arm.start_elevation_deg - self._travel[1], -Z_TRAVEL / 2)
        self.arm = GrblController(clock, light_arm_settings((*self._travel, Z_TRAVEL)), start)

    def pose(self, time_s: float) -> tuple[float, float, float, float]:
        """Return turntable angle, azimuth and elevation in degrees, and lamp 0..1, at any time of the last seconds."""
        x, y, _ = self.arm.position(time_s)
        azimuth_deg, elevation_deg = x + self._travel[0], y + self._travel[1]
        return self.table.angle_deg(time_s), azimuth_deg, elevation_deg, self.arm.lamp.power_at(time_s)

    def listen_at(self, baud: int) -> None:
        """Let the servos listen at another speed than they did."""
        for servo in self.bus.servos:
            servo.memory[Register.BAUD_RATE] = next(code for code, speed in BAUDS.items() if speed == baud)

    def _befall(self, faults: TurntableFaults) -> None:
        """Let the mishaps be there from the start."""
        servo, bus = self.servo, self.bus
        bus.faults.spread(faults)
        bus.faults.echo, bus.faults.clash, bus.groups = faults.echo, faults.id_clash, faults.groups
        self.table.play_deg, self.table.slip_deg = faults.play_deg, faults.slip_deg
        servo.stall_at_deg, servo.overload_after_s = faults.stall_at_deg, faults.overload_after_s
        servo.overshoot_deg = faults.overshoot_deg
        for register, value in (
            (Register.MODEL_NUMBER, faults.model_number),
            (Register.FIRMWARE_VERSION, faults.firmware),
        ):
            servo.memory[register] = servo.memory[register] if value is None else value
        if faults.alert_bits:
            servo.fail_hardware(faults.alert_bits)
        if faults.listens_at is not None:
            self.listen_at(faults.listens_at)
