"""Parts of a session that was shot at many angles and under many lights: one angle for a PTM, one light for an AMC."""

from collections.abc import Callable
from dataclasses import replace

from litrig.base.capture_folder.capture import Capture, CapturedFrame, Role
from litrig.base.capture_folder.pairing import listed
from litrig.base.directions import F64, angle_between_deg, angles_from_direction, turn_between_deg
from litrig.base.errors import InputError

SAME_DEG = 1.0
"""Poses that lie closer together are taken for one."""


def at_one_angle(capture: Capture, angle_deg: float | None) -> Capture:
    """Keep the frames that were shot at one angle of the turntable, for a material that is lit from many directions.

    Parameters
    ----------
    angle_deg : which; None where all have the same, or none

    Raises
    ------
    InputError
        There are several and none was named, or none is there.
    """
    angles = _distinct([frame.angle_deg for frame in capture.having(Role.FRAME) if frame.angle_deg is not None])
    if angle_deg is None:
        if len(angles) < 2:
            return capture
        shown = listed([_deg(angle) for angle in angles])
        raise InputError(f"{capture.folder}: was shot at {len(angles)} angles, {shown}; name one with --angle")
    return _only(
        capture,
        lambda frame: frame.angle_deg is not None and abs(turn_between_deg(frame.angle_deg, angle_deg)) < SAME_DEG,
        f"at {_deg(angle_deg)}; its angles are {listed([_deg(a) for a in angles])}",
    )


def under_one_light(capture: Capture, light: F64 | None) -> Capture:
    """Keep the frames that were shot under one light, for a material that turns under it.

    Parameters
    ----------
    light : (3,) direction, view frame; None where all have the same, or none is known

    Raises
    ------
    InputError
        There are several and none was named, or none is there.
    """
    turned = [frame for frame in capture.having(Role.FRAME) if frame.angle_deg is not None]
    lights: list[F64] = []
    for frame in turned:
        if frame.light is not None and all(angle_between_deg(frame.light, other) > SAME_DEG for other in lights):
            lights.append(frame.light)
    shown = listed([_azimuth_elevation(each) for each in lights])
    if light is None:
        if len(lights) < 2:
            return capture
        raise InputError(
            f"{capture.folder}: was shot under {len(lights)} lights, {shown}; name one with --under AZIMUTH ELEVATION"
        )
    wanted = light
    return _only(
        capture,
        lambda frame: frame.light is not None and angle_between_deg(frame.light, wanted) < SAME_DEG,
        f"under a light at {_azimuth_elevation(light)}; its lights are at {shown or 'unknown places'}",
    )


def _only(capture: Capture, fits: Callable[[CapturedFrame], bool], which: str) -> Capture:
    frames = tuple(frame for frame in capture.frames if frame.role is not Role.FRAME or fits(frame))
    if not any(frame.role is Role.FRAME for frame in frames):
        raise InputError(f"{capture.folder}: nothing was shot {which}")
    return replace(capture, frames=frames)


def _distinct(angles_deg: list[float]) -> list[float]:
    found: list[float] = []
    for angle in angles_deg:
        if all(abs(turn_between_deg(angle, other)) > SAME_DEG for other in found):
            found.append(angle)
    return found


def _deg(angle_deg: float) -> str:
    return f"{round(angle_deg, 1):g}°"


def _azimuth_elevation(light: F64) -> str:
    azimuth_deg, elevation_deg = angles_from_direction(light)
    return f"{azimuth_deg:.1f}° {elevation_deg:.1f}°"
