"""Shooting a plan, one small step after the other, and saying what happened.

A frame counts only when the pose was in tolerance before and after its exposure, the exposure began after the pose had
settled, and the frame and its journal line are on the disk.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from acquisition.plans import Plan, Step
from acquisition.quality import Inspector, Quality
from litrig.base.capture_folder.writer import CaptureFolderWriter, make_thumbnail
from litrig.base.directions import angle_between_deg, direction_from_angles
from litrig.base.errors import FormatError, HoldError, InputError
from rig.devices import ArmPose, Shot, TurntablePose
from rig.errors import CameraError, RigError
from rig.rig import Rig

TRIES = 3


@dataclass(frozen=True)
class Poses:
    """Where everything stood at one instant."""

    turntable: TurntablePose | None
    light: ArmPose | None

    def as_json(self) -> Mapping[str, float]:
        """Return them as the journal has them."""
        angles = {} if self.turntable is None else {"angle_deg": round(self.turntable.angle_deg, 4)}
        return angles if self.light is None else {**angles, **_rounded(asdict(self.light))}


@dataclass(frozen=True)
class FrameTaken:
    """A frame is on the disk and counts."""

    step: Step
    file: str
    quality: Quality
    pose_error_deg: float


@dataclass(frozen=True)
class Paused:
    """The operator asked for a pause; the rig stays where it is."""

    frames: int


RunEvent = FrameTaken | Paused


def check_plan(plan: Plan, rig: Rig) -> None:
    """Refuse a plan that the rig cannot shoot, before anything moves.

    Raises
    ------
    OutOfRangeError
        A step lies beyond the limits.
    RigError
        The rig lacks a part that the plan needs.
    """
    _ = rig.camera
    for step in plan:
        if step.angle_deg is not None:
            rig.turntable.check(step.angle_deg)
        if step.aim is not None:
            rig.check_light(step.aim.azimuth_deg, step.aim.elevation_deg, step.aim.lamp)


def run(plan: Plan, rig: Rig, writer: CaptureFolderWriter, pause_requested: Callable[[], bool]) -> Iterator[RunEvent]:
    """Home the rig, shoot every step, park.

    Raises
    ------
    HoldError
        Something failed that a retry does not mend. The rig holds; the frames so far are safe.
    """
    inspector = Inspector()
    try:
        rig.get_ready()
        for done, step in enumerate(plan):
            if pause_requested():
                rig.pause()
                writer.record("pause", frames=done)
                yield Paused(done)
                return
            yield _take(step, rig, writer, inspector)
        rig.park()
    except KeyboardInterrupt:
        rig.hold()
        with suppress(InputError):
            writer.record("stop")
        raise
    except (RigError, InputError) as error:
        rig.hold()
        with suppress(InputError):  # a full disk may be why
            writer.record("hold", reason=str(error))
        raise HoldError(f"{error}. The rig is on hold; the frames so far are safe in {writer.folder}") from error


def _take(step: Step, rig: Rig, writer: CaptureFolderWriter, inspector: Inspector) -> FrameTaken:
    reason = ""
    for attempt in range(1, TRIES + 1):
        _go(step, rig)
        before = _locate(step, rig)
        shot = rig.expose(rig.clock.now_s())
        after = _locate(step, rig)
        pose_error_deg, reason = _judge_poses(step, rig, (before, after))
        if not reason:
            try:
                codes, quality = inspector.inspect(shot.content, shot.ending, "camera")
                reason = quality.fault
            except FormatError as error:
                reason = str(error)
        if not reason:
            name = step.stem + ("" if attempt == 1 else f"_try{attempt}") + shot.ending
            fields = _journal_fields(step, attempt, before, after, shot, quality)
            entry = writer.add_frame(name, shot.content, make_thumbnail(codes), **fields)
            return FrameTaken(step, entry["file"], quality, pose_error_deg)
        writer.record("retry", step=step.step, attempt=attempt, reason=reason)
    raise CameraError(f"step {step.step}: after {TRIES} tries the frame {reason}")


def _go(step: Step, rig: Rig) -> None:
    if step.angle_deg is not None:
        rig.turn_to(step.angle_deg)
    if step.aim is not None:
        rig.light_from(step.aim.azimuth_deg, step.aim.elevation_deg, step.aim.lamp)


def _locate(step: Step, rig: Rig) -> Poses:
    return Poses(
        None if step.angle_deg is None else rig.turntable.locate(),
        None if step.aim is None else rig.locate_light(step.aim.lamp),
    )


def _judge_poses(step: Step, rig: Rig, poses: tuple[Poses, Poses]) -> tuple[float, str]:
    """Return the largest error in degrees of the poses before and after, and what is wrong with it, if anything is."""
    turned_deg = lit_deg = 0.0
    for pose in poses:
        if step.angle_deg is not None and pose.turntable is not None:
            turned_deg = max(turned_deg, abs(pose.turntable.angle_deg - step.angle_deg))
        if step.aim is not None and pose.light is not None:
            wanted = direction_from_angles(step.aim.azimuth_deg, step.aim.elevation_deg)
            found = direction_from_angles(pose.light.azimuth_deg, pose.light.elevation_deg)
            lit_deg = max(lit_deg, angle_between_deg(wanted, found))
    # Both joints of the arm may be off at once.
    for part, off_deg, joints in ((rig.config.turntable, turned_deg, 1), (rig.config.arm, lit_deg, 2)):
        if part is not None and off_deg > part.tolerance_deg * math.sqrt(joints):
            return off_deg, f"was taken {off_deg:.2f}° off its pose; look what moves the rig"
    return max(turned_deg, lit_deg), ""


def _journal_fields(
    step: Step, attempt: int, before: Poses, after: Poses, shot: Shot, quality: Quality
) -> Mapping[str, Any]:
    goal = {} if step.angle_deg is None else {"angle_deg": step.angle_deg}
    fields: dict[str, Any] = {
        "step": step.step,
        "try": attempt,
        "role": step.role.value,
        "pose_goal": goal if step.aim is None else {**goal, **asdict(step.aim)},
        "pose_before": before.as_json(),
        "pose_after": after.as_json(),
    }
    if after.light is not None:
        light = direction_from_angles(after.light.azimuth_deg, after.light.elevation_deg)
        fields["light"] = [round(float(component), 6) for component in light / np.linalg.norm(light)]
    fields["camera"] = dict(shot.settings)
    fields["exposed"] = {"from_s": round(shot.exposed_from_s, 6), "to_s": round(shot.exposed_to_s, 6)}
    fields["checks"] = quality.as_json()
    fields["verdict"] = "good"
    return fields


def _rounded(values: Mapping[str, float]) -> dict[str, float]:
    return {key: round(value, 4) for key, value in values.items()}
