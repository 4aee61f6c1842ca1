"""The control table of the XL430-W250 (model 1060) as data: where what stands, and what may be written."""

from dataclasses import dataclass
from enum import IntEnum, IntFlag

MODEL_NUMBER = 1060
FIRMWARE_VERSION = 45
FIRST_RAM_ADDRESS = 64
"""What lies below is EEPROM: it survives a reboot, and is locked while torque is on."""
TABLE_BYTES = 148
COUNTS_PER_TURN = 4096
VELOCITY_UNIT_DEG_S = 0.229 * 360 / 60
ACCELERATION_UNIT_DEG_S2 = 214.577 * 360 / 3600
BAUDS = {0: 9_600, 1: 57_600, 2: 115_200, 3: 1_000_000, 4: 2_000_000, 5: 3_000_000, 6: 4_000_000, 7: 4_500_000}


class Mode(IntEnum):
    """Operating modes that are simulated; the servo itself knows velocity (1) and PWM (16) besides."""

    POSITION = 3
    EXTENDED_POSITION = 4


class DriveMode(IntFlag):
    """Bits of the drive mode."""

    REVERSE = 0b0001
    TIME_BASED_PROFILE = 0b0100
    TORQUE_ON_BY_GOAL = 0b1000


class Startup(IntFlag):
    """Bits of the startup configuration: what a reboot does not take away."""

    TORQUE_ON = 0b01
    RAM_RESTORE = 0b10


class Register(IntEnum):
    """Addresses by name."""

    MODEL_NUMBER = 0
    MODEL_INFORMATION = 2
    FIRMWARE_VERSION = 6
    ID = 7
    BAUD_RATE = 8
    RETURN_DELAY_TIME = 9
    DRIVE_MODE = 10
    OPERATING_MODE = 11
    SHADOW_ID = 12
    PROTOCOL_TYPE = 13
    HOMING_OFFSET = 20
    MOVING_THRESHOLD = 24
    TEMPERATURE_LIMIT = 31
    MAX_VOLTAGE_LIMIT = 32
    MIN_VOLTAGE_LIMIT = 34
    PWM_LIMIT = 36
    VELOCITY_LIMIT = 44
    MAX_POSITION_LIMIT = 48
    MIN_POSITION_LIMIT = 52
    STARTUP_CONFIGURATION = 60
    SHUTDOWN = 63
    TORQUE_ENABLE = 64
    LED = 65
    STATUS_RETURN_LEVEL = 68
    REGISTERED_INSTRUCTION = 69
    HARDWARE_ERROR_STATUS = 70
    VELOCITY_I_GAIN = 76
    VELOCITY_P_GAIN = 78
    POSITION_D_GAIN = 80
    POSITION_I_GAIN = 82
    POSITION_P_GAIN = 84
    FEEDFORWARD_2ND_GAIN = 88
    FEEDFORWARD_1ST_GAIN = 90
    BUS_WATCHDOG = 98
    GOAL_PWM = 100
    GOAL_VELOCITY = 104
    PROFILE_ACCELERATION = 108
    PROFILE_VELOCITY = 112
    GOAL_POSITION = 116
    REALTIME_TICK = 120
    MOVING = 122
    MOVING_STATUS = 123
    PRESENT_PWM = 124
    PRESENT_LOAD = 126
    PRESENT_VELOCITY = 128
    PRESENT_POSITION = 132
    VELOCITY_TRAJECTORY = 136
    POSITION_TRAJECTORY = 140
    PRESENT_INPUT_VOLTAGE = 144
    PRESENT_TEMPERATURE = 146
    BACKUP_READY = 147


@dataclass(frozen=True)
class Item:
    """One entry: `limits` None means that the host may only read it."""

    register: Register
    size: int
    initial: int
    limits: tuple[int, int] | None = None

    @property
    def end(self) -> int:
        return self.register + self.size


_LARGEST_POSITION = 1_048_575

TABLE = (
    Item(Register.MODEL_NUMBER, 2, MODEL_NUMBER),
    Item(Register.MODEL_INFORMATION, 4, 0),
    Item(Register.FIRMWARE_VERSION, 1, FIRMWARE_VERSION),
    Item(Register.ID, 1, 1, (0, 252)),
    Item(Register.BAUD_RATE, 1, 1, (0, 7)),
    Item(Register.RETURN_DELAY_TIME, 1, 250, (0, 254)),
    Item(Register.DRIVE_MODE, 1, 0, (0, 0b1101)),
    Item(Register.OPERATING_MODE, 1, Mode.POSITION, (Mode.POSITION, Mode.EXTENDED_POSITION)),
    Item(Register.SHADOW_ID, 1, 255, (0, 255)),
    Item(Register.PROTOCOL_TYPE, 1, 2, (2, 2)),
    Item(Register.HOMING_OFFSET, 4, 0, (-1_044_479, 1_044_479)),
    Item(Register.MOVING_THRESHOLD, 4, 10, (0, 1023)),
    Item(Register.TEMPERATURE_LIMIT, 1, 72, (0, 100)),
    Item(Register.MAX_VOLTAGE_LIMIT, 2, 140, (60, 140)),
    Item(Register.MIN_VOLTAGE_LIMIT, 2, 60, (60, 140)),
    Item(Register.PWM_LIMIT, 2, 885, (0, 885)),
    Item(Register.VELOCITY_LIMIT, 4, 265, (0, 1023)),
    Item(Register.MAX_POSITION_LIMIT, 4, 4095, (0, 4095)),
    Item(Register.MIN_POSITION_LIMIT, 4, 0, (0, 4095)),
    Item(Register.STARTUP_CONFIGURATION, 1, 0, (0, 3)),
    Item(Register.SHUTDOWN, 1, 0b0011_0100, (0, 0b0011_1101)),
    Item(Register.TORQUE_ENABLE, 1, 0, (0, 1)),
    Item(Register.LED, 1, 0, (0, 1)),
    Item(Register.STATUS_RETURN_LEVEL, 1, 2, (0, 2)),
    Item(Register.REGISTERED_INSTRUCTION, 1, 0),
    Item(Register.HARDWARE_ERROR_STATUS, 1, 0),
    Item(Register.VELOCITY_I_GAIN, 2, 1000, (0, 16383)),
    Item(Register.VELOCITY_P_GAIN, 2, 100, (0, 16383)),
    Item(Register.POSITION_D_GAIN, 2, 4000, (0, 16383)),
    Item(Register.POSITION_I_GAIN, 2, 0, (0, 16383)),
    Item(Register.POSITION_P_GAIN, 2, 640, (0, 16383)),
    Item(Register.FEEDFORWARD_2ND_GAIN, 2, 0, (0, 16383)),
    Item(Register.FEEDFORWARD_1ST_GAIN, 2, 0, (0, 16383)),
    Item(Register.BUS_WATCHDOG, 1, 0, (0, 127)),
    Item(Register.GOAL_PWM, 2, 885, (-885, 885)),
    Item(Register.GOAL_VELOCITY, 4, 0, (-1023, 1023)),
    Item(Register.PROFILE_ACCELERATION, 4, 0, (0, 32767)),
    Item(Register.PROFILE_VELOCITY, 4, 0, (0, 32767)),
    Item(Register.GOAL_POSITION, 4, 0, (-_LARGEST_POSITION, _LARGEST_POSITION)),
    Item(Register.REALTIME_TICK, 2, 0),
    Item(Register.MOVING, 1, 0),
    Item(Register.MOVING_STATUS, 1, 0),
    Item(Register.PRESENT_PWM, 2, 0),
    Item(Register.PRESENT_LOAD, 2, 0),
    Item(Register.PRESENT_VELOCITY, 4, 0),
    Item(Register.PRESENT_POSITION, 4, 0),
    Item(Register.VELOCITY_TRAJECTORY, 4, 0),
    Item(Register.POSITION_TRAJECTORY, 4, 0),
    Item(Register.PRESENT_INPUT_VOLTAGE, 2, 120),
    Item(Register.PRESENT_TEMPERATURE, 1, 34),
    Item(Register.BACKUP_READY, 1, 0),
)
