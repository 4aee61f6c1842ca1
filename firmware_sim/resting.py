"""Where the devices come to rest, and when they did."""

from collections.abc import Callable

from firmware_sim.config import SimConfig
from firmware_sim.dynamixel.control_table import COUNTS_PER_TURN
from firmware_sim.grbl.planner import on_steps
from firmware_sim.grbl.settings import light_arm_settings
from firmware_sim.motion import MEMORY_S
from firmware_sim.scene.pose import PlannedPose, Pose

LOOK_S = 0.05
"""How far apart the past is looked at, at first."""
HALVINGS = 16
DEG_PER_COUNT = 360 / COUNTS_PER_TURN


def resting_pose(planned: PlannedPose, now: Pose, config: SimConfig) -> Pose:
    """Return where the devices will truly stand when a host sends them to a pose.

    The servo rests on counts of its encoder, the arm on steps of its motors, which hear of three decimals.

    Parameters
    ----------
    planned : as a plan asks; the devices are mounted as the simulator's RIG.toml says
    now : where they are, for what the plan leaves alone
    config : what is simulated
    """
    turntable_deg, azimuth_deg, elevation_deg = now[:3]
    if planned.turntable_deg is not None:
        steps_per_deg = 1 / DEG_PER_COUNT if config.stepper is None else config.stepper.steps_per_deg
        turntable_deg = round(planned.turntable_deg * steps_per_deg) / steps_per_deg
    if planned.azimuth_deg is not None:
        azimuth_deg = _on_steps(planned.azimuth_deg, config.arm.azimuth_travel_deg)
    if planned.elevation_deg is not None:
        elevation_deg = _on_steps(planned.elevation_deg, config.arm.elevation_travel_deg)
    return Pose(turntable_deg, azimuth_deg, elevation_deg, planned.lamp)


def last_elsewhere_s(pose_at: Callable[[float], Pose], until_s: float) -> float:
    """Return an instant before the pose of `until_s` was reached: as late as can be found, within a microsecond.

    Parameters
    ----------
    pose_at : gives the pose at any time of the last seconds
    until_s : when the pose has come to rest
    """
    rest = pose_at(until_s)
    late_s = until_s
    while late_s > until_s - MEMORY_S:
        early_s = late_s - LOOK_S
        if pose_at(early_s) != rest:
            return _bisect(pose_at, rest, early_s, late_s)
        late_s = early_s
    return late_s  # nobody remembers anything else


def _bisect(pose_at: Callable[[float], Pose], rest: Pose, early_s: float, late_s: float) -> float:
    for _ in range(HALVINGS):
        middle_s = (early_s + late_s) / 2
        if pose_at(middle_s) == rest:
            late_s = middle_s
        else:
            early_s = middle_s
    return early_s


def _on_steps(angle_deg: float, travel_deg: float) -> float:
    machine = round(angle_deg % 360 - travel_deg, 3)
    return on_steps((machine, 0.0, 0.0), light_arm_settings((travel_deg, travel_deg, travel_deg)))[0] + travel_deg
