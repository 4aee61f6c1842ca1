"""What only motion shows: homing, travel, arrival, and a lamp that changes the picture."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np

from litrig.base.directions import angle_between_deg, direction_from_angles
from litrig.base.errors import LitrigError
from rig.config import AlwaysOnConfig, RigConfig
from rig.doctor.camera import codes_of, mean_of
from rig.doctor.finding import Finding, Findings, Part
from rig.errors import OutOfRangeError
from rig.rig import Rig, open_rig

LEAST_CHANGE = 0.004
"""By which a lamp must change the mean of the picture, of full scale: a code of an 8-bit picture."""
NOISE_FACTOR = 5
ANGLES_DEG = range(-1080, 1081)
AZIMUTHS_DEG = (0.0, 90.0, 180.0, 270.0)
ELEVATIONS_DEG = tuple(float(elevation) for elevation in range(0, 91, 2))
MOST_LAMPS = 512


def examine_moving(config: RigConfig, environment: Mapping[str, str] | None = None) -> Iterator[Finding]:
    """Move everything through its travel and look at what the lamps do; at the end the rig is parked.

    Parameters
    ----------
    environment : added to the environment of the camera's process

    Raises
    ------
    KeyboardInterrupt
        The operator stopped it; the rig holds.
    """
    if config.turntable is not None:
        yield from _with_rig(config, ("turntable",), environment, _turntable)
    if config.arm is not None:
        yield from _with_rig(config, ("arm", "lights"), environment, _arm)
    if config.lights is not None and config.camera is not None:
        yield from _with_rig(config, ("arm", "lights", "camera"), environment, _lamps)


def _with_rig(
    config: RigConfig, parts: Sequence[str], environment: Mapping[str, str] | None, look: Callable[[Rig], Findings]
) -> Findings:
    """Open some parts and look at them; an error ends the look, with the rig on hold."""
    try:
        with open_rig(config, use=frozenset(parts), environment=environment) as rig:
            yield from look(rig)
    except LitrigError as error:
        yield Part(parts[-1] if look is _lamps else parts[0]).refused("motion", error)


def _turntable(rig: Rig) -> Findings:
    part, config = Part("turntable"), rig.config.turntable
    assert config is not None  # noqa: S101  # looked at before
    rig.turntable.home()
    yield part.ok("homing", "ready, torque on")
    reached = [float(angle) for angle in ANGLES_DEG if _accepts(rig.turntable.check, float(angle))]
    if not reached:
        yield part.fault("travel", "reaches no angle at all", "check the turntable's limits in RIG.toml")
        return
    worst_deg = 0.0
    for goal_deg in (reached[0], reached[-1], config.park_deg):
        worst_deg = max(worst_deg, abs(rig.turn_to(goal_deg).angle_deg - goal_deg))
    yield part.ok("travel", f"went to {reached[0]:g}° and {reached[-1]:g}°")
    yield _arrival(part, worst_deg, config.tolerance_deg)
    rig.turntable.release()


def _arm(rig: Rig) -> Findings:
    part, config = Part("arm"), rig.config.arm
    assert config is not None  # noqa: S101  # looked at before
    rig.arm.home()
    yield part.ok("homing", "found its switches")
    rig.lights.switch_off()
    goals = list(_tour(rig))
    if not goals:
        yield part.fault("travel", "reaches no direction at all", "check the arm's origins and limits in RIG.toml")
        return
    worst_deg = 0.0
    for azimuth_deg, elevation_deg in goals:
        pose = rig.arm.move_to(azimuth_deg, elevation_deg)
        there = direction_from_angles(pose.azimuth_deg, pose.elevation_deg)
        worst_deg = max(worst_deg, angle_between_deg(direction_from_angles(azimuth_deg, elevation_deg), there))
    azimuths, elevations = zip(*goals, strict=True)
    yield part.ok(
        "travel",
        f"went to azimuth {min(azimuths):g}° to {max(azimuths):g}°, elevation {min(elevations):g}° to "
        f"{max(elevations):g}°",
    )
    yield _arrival(part, worst_deg, 2 * config.tolerance_deg)
    rig.arm.move_to(config.park_azimuth_deg, config.park_elevation_deg)


def _tour(rig: Rig) -> Iterator[tuple[float, float]]:
    """Yield directions at the edges of what the arm reaches: at four azimuths the lowest and the highest."""
    for azimuth_deg in AZIMUTHS_DEG:
        reached = [elevation for elevation in ELEVATIONS_DEG if _accepts(rig.arm.check, azimuth_deg, elevation)]
        if reached:
            yield azimuth_deg, reached[0]
            yield azimuth_deg, reached[-1]


def _accepts(check: Callable[..., None], *angles_deg: float) -> bool:
    try:
        check(*angles_deg)
    except OutOfRangeError:
        return False
    return True


def _lamps(rig: Rig) -> Findings:
    """Compare the picture with each lamp on and off."""
    part = Part("lights")
    if isinstance(rig.config.lights, AlwaysOnConfig):
        yield part.ok("effect", "always on; not tried")
        return
    if rig.config.arm is not None:
        rig.arm.home()
        rig.arm.move_to(rig.config.arm.park_azimuth_deg, rig.config.arm.park_elevation_deg)
    rig.lights.switch_off()
    dark = [_mean(rig) for _ in range(3)]
    noise = max(dark) - min(dark)
    dull = []
    lamps = list(_lamp_numbers(rig))
    for lamp in lamps:
        rig.lights.switch_on(lamp)
        if abs(_mean(rig) - float(np.mean(dark))) < max(LEAST_CHANGE, NOISE_FACTOR * noise):
            dull.append(lamp)
        rig.lights.switch_off()
    if dull:
        yield part.fault(
            "effect",
            f"lamp {', '.join(map(str, dull))} does not change the picture",
            "check its cable and driver, that the camera sees the sample, and that the room is dark",
        )
    else:
        yield part.ok("effect", f"lamps that change the picture: {len(lamps)} of {len(lamps)}")


def _lamp_numbers(rig: Rig) -> Iterator[int]:
    with suppress(OutOfRangeError):
        for lamp in range(MOST_LAMPS):
            rig.lights.check(lamp)
            yield lamp


def _mean(rig: Rig) -> float:
    return mean_of(codes_of(rig.expose(rig.clock.now_s())))


def _arrival(part: Part, worst_deg: float, tolerance_deg: float) -> Finding:
    if worst_deg > tolerance_deg:
        return part.fault("arrival", f"{worst_deg:.2f}° off its goal", "look for what blocks it, and at the tolerance")
    return part.ok("arrival", f"at most {worst_deg:.2f}° off its goals")
