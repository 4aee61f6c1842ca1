"""The turntable on a GRBL axis: its settings, and where it stands."""

from firmware_sim.grbl.config import StepperSim
from firmware_sim.grbl.homing import switch_positions
from firmware_sim.grbl.settings import AXES, HOMING, SOFT_LIMITS, STEPS, TRAVEL, Settings, light_arm_settings

TRAVEL_DEG = 1080.0
"""How far a table with a switch may turn: three turns."""


def own_settings(config: StepperSim) -> Settings:
    """Return the settings of a controller that turns nothing but the table."""
    number = AXES.index(config.axis)
    count = max(3, number + 1)
    travel = [0.0] * count
    travel[number] = 0.0 if config.switch_deg is None else TRAVEL_DEG
    settings = light_arm_settings(tuple(travel))
    if count > 3 or config.switch_deg is not None:
        settings |= {44: 1 << number, 45: 0, 46: 0, 47: 0}
    if config.switch_deg is None:
        settings |= {SOFT_LIMITS: 0, HOMING: 0}
    # Motors that hold the table do so at rest too.
    return settings | {1: 255, STEPS + number: config.steps_per_deg} | config.settings


def shared_settings(config: StepperSim) -> Settings:
    """Return what the axis adds to the settings of the arm's controller."""
    number = AXES.index(config.axis)
    travel = 0.0 if config.switch_deg is None else TRAVEL_DEG
    added: Settings = {1: 255, STEPS + number: config.steps_per_deg, TRAVEL + number: travel}
    masks = {44: 0 if config.switch_deg is None else 1 << number, 45: 3, 46: 0, 47: 0}
    return added | masks


def start_position(config: StepperSim, settings: Settings) -> float:
    """Return the machine coordinate, of a homed table, where it stands when the power comes on."""
    if config.switch_deg is None:
        return config.start_deg
    switch = switch_positions(settings)[AXES.index(config.axis)]
    return switch + config.start_deg - config.switch_deg


def stepper_toml(config: StepperSim, port: str) -> str:
    """Describe the table as a person would in RIG.toml."""
    lines = [
        "[turntable]",
        'kind = "grbl"',
        f'port = "{port}"',
        f'axis = "{config.axis}"',
        f"steps_per_deg = {config.steps_per_deg:.3f}",
    ]
    if config.switch_deg is not None:
        # The axis counts from 0 at the switch downwards.
        low = config.switch_deg - TRAVEL_DEG
        lines += [
            'zero = "switch"',
            f"origin_deg = {-config.switch_deg:.3f}",
            f"min_deg = {low:.3f}",
            f"max_deg = {config.switch_deg:.3f}",
        ]
    return "\n".join(lines) + "\n"


def angle_deg(position: float, config: StepperSim, settings: Settings) -> float:
    """Return the table's angle at a true position of the axis."""
    if config.switch_deg is None:
        return position
    return position - switch_positions(settings)[AXES.index(config.axis)] + config.switch_deg
