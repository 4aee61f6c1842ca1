"""Whether a rig can shoot a plan, judged by its RIG.toml alone: no port is opened, and nothing moves."""

from collections.abc import Iterable

from acquisition.forecast_motion import ArmMotion
from acquisition.plans import Aim, Plan, Step
from litrig.base.directions import angle_between_deg, direction_from_angles
from litrig.base.errors import InputError
from rig.config import ArmConfig, RigConfig
from rig.errors import OutOfRangeError, RigError
from rig.rig import DOME_TOLERANCE_DEG


def check_against(plan: Plan, config: RigConfig) -> tuple[str, ...]:
    """Refuse a plan that the rig cannot shoot.

    Returns
    -------
    remarks : what could not be checked without the devices

    Raises
    ------
    InputError
        The rig lacks a part that the plan needs, or a step is beyond its limits; the message has step and reason.
    """
    if config.camera is None:
        raise InputError("the rig has no camera: RIG.toml has no [camera]; add it, or use another rig")
    arm = ArmMotion(config.arm) if isinstance(config.arm, ArmConfig) else None
    seen: set[tuple[float | None, Aim | None]] = set()
    for step in plan:
        if (step.angle_deg, step.aim) in seen:
            continue
        seen.add((step.angle_deg, step.aim))
        try:
            _check_angle(step, config)
            _check_aim(step.aim, config, arm)
        except RigError as error:
            raise InputError(f"step {step.step} ({step.stem}): {error}") from error
    return tuple(_unchecked(plan, config))


def _check_angle(step: Step, config: RigConfig) -> None:
    if step.angle_deg is None:
        return
    if config.turntable is None:
        raise RigError("the rig has no turntable: RIG.toml has no [turntable]; add it, or use another rig")
    config.turntable.check_limits(step.angle_deg)


def _check_aim(aim: Aim | None, config: RigConfig, arm: ArmMotion | None) -> None:
    if aim is None:
        return
    if config.lights is None:
        raise RigError("the rig has no lights: RIG.toml has no [lights]; add it, or use another rig")
    if config.lights.directions_deg:
        _check_lamp(aim, config.lights.directions_deg)
    elif config.arm is None:
        raise RigError(
            "the rig has no arm, and its lamps have no directions; add [arm] to RIG.toml, or directions to its lamps"
        )
    elif arm is not None:
        arm.places(aim)


def _check_lamp(aim: Aim, directions_deg: tuple[tuple[float, float], ...]) -> None:
    if aim.lamp not in range(len(directions_deg)):
        raise OutOfRangeError(f"lights: lamp {aim.lamp} does not exist; the rig has 0..{len(directions_deg) - 1}")
    there = directions_deg[aim.lamp]
    wanted = direction_from_angles(aim.azimuth_deg, aim.elevation_deg)
    if not angle_between_deg(direction_from_angles(*there), wanted) <= DOME_TOLERANCE_DEG:
        raise OutOfRangeError(
            f"lights: lamp {aim.lamp} hangs at azimuth {there[0]:g}°, elevation {there[1]:g}°, not at "
            f"{aim.azimuth_deg:g}°, {aim.elevation_deg:g}°; ask for its own direction"
        )


def _unchecked(plan: Plan, config: RigConfig) -> Iterable[str]:
    has_dome = config.lights is not None and config.lights.directions_deg
    if plan.poses.aims and not has_dome and config.arm is not None and not isinstance(config.arm, ArmConfig):
        yield f"what an arm of kind {config.arm.kind} reaches only its driver knows; it is checked before it moves"
