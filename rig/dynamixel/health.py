"""How a servo is: supply, temperature, and what its hardware error status says."""

from dataclasses import dataclass

from rig.dynamixel import registers
from rig.dynamixel.link import ServoLink
from rig.dynamixel.models import name_of
from rig.dynamixel.registers import Values

VOLT = 0.1
"""The unit of all voltages."""


@dataclass(frozen=True)
class ServoHealth:
    """What a servo tells about itself.

    Attributes
    ----------
    input_v, min_input_v, max_input_v : the supply now, and the servo's own limits
    temperature_deg_c, max_temperature_deg_c : the inside now, and the servo's own limit
    errors : what the hardware error status says, in words; empty if all is well
    torque : whether it holds
    """

    model: str
    firmware: int
    input_v: float
    min_input_v: float
    max_input_v: float
    temperature_deg_c: int
    max_temperature_deg_c: int
    errors: str
    torque: bool

    def complaints(self) -> list[str]:
        """Say what is wrong, and what to do."""
        found = []
        if self.errors:
            found.append(f"hardware error: {self.errors}; remove the cause, then switch its power off and on")
        if not self.min_input_v <= self.input_v <= self.max_input_v:
            found.append(
                f"its supply is {self.input_v:.1f} V, it wants {self.min_input_v:.1f} to {self.max_input_v:.1f} V; "
                "check the power supply"
            )
        if self.temperature_deg_c >= self.max_temperature_deg_c:
            found.append(
                f"it has {self.temperature_deg_c} °C, its limit is {self.max_temperature_deg_c} °C; let it cool"
            )
        return found


def read_health(link: ServoLink) -> ServoHealth:
    """Ask a servo how it is."""
    identity = link.ping()
    settings, state = link.read_block(registers.EEPROM), link.read_block(registers.STATE)
    return ServoHealth(
        name_of(identity.model_number),
        identity.firmware,
        round(state[registers.PRESENT_VOLTAGE] * VOLT, 1),
        round(settings[registers.MIN_VOLTAGE_LIMIT] * VOLT, 1),
        round(settings[registers.MAX_VOLTAGE_LIMIT] * VOLT, 1),
        state[registers.PRESENT_TEMPERATURE],
        settings[registers.TEMPERATURE_LIMIT],
        registers.hardware_errors(state[registers.HARDWARE_ERROR]),
        bool(state[registers.TORQUE_ENABLE]),
    )


def complaint(state: Values) -> str:
    """Say which hardware errors a state has, what became of torque and position, and what to do."""
    status = state[registers.HARDWARE_ERROR]
    torque = "it holds" if state[registers.TORQUE_ENABLE] else "it has let go"
    kept = "lost" if status & registers.ENCODER_FAULT else "kept"
    return (
        f"hardware error: {registers.hardware_errors(status)}; remove the cause, then switch the servo's power off "
        f"and on ({torque}, its position is {kept} until then)"
    )
