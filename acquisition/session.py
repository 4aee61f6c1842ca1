"""A capture session from an absent folder to a closed bag."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.plans import Plan
from acquisition.runner import FrameTaken, Paused, check_plan, run
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import read_journal
from litrig.base.capture_folder.reader import good_frames
from litrig.base.capture_folder.writer import CaptureFolderWriter, check_free, check_object_id
from litrig.base.lights import Lights
from litrig.base.progress import Progress, Report, silent
from litrig.base.version import litrig_version
from rig.config import RigConfig
from rig.interrupts import Interrupts
from rig.rig import open_rig


@dataclass(frozen=True)
class SessionInfo:
    """What the operator says about a session."""

    object_id: str = "object"
    tangent_zero_deg: float = 0.0


def capture(
    config: RigConfig,
    plan: Plan,
    folder: Path,
    info: SessionInfo,
    *,
    report: Report = silent,
    environment: Mapping[str, str] | None = None,
) -> bool:
    """Shoot a plan into a new capture folder, and close it as a valid bag.

    Nothing is created before the rig is open and the plan is known to be within its reach.

    Parameters
    ----------
    folder : absent or empty
    environment : added to the environment of the camera's process

    Returns
    -------
    complete : False if the operator paused it; the folder is then an open session with every frame so far

    Raises
    ------
    InputError, RigError
        Before anything moved.
    HoldError
        The rig stopped in the middle and needs a person; the frames so far are safe.
    """
    check_free(folder)
    check_object_id(info.object_id)
    started = datetime.now(UTC).isoformat(timespec="seconds")
    with (
        Interrupts(can_pause=True) as interrupts,
        open_rig(config, use=_needed(plan, config), environment=environment) as rig,
    ):
        check_plan(plan, rig)
        session = _resolved(config, plan, info, started)
        with CaptureFolderWriter.create(folder, info.object_id, session, (step.as_json() for step in plan)) as writer:
            report(Progress(f"capture {info.object_id}", 0, len(plan), "homing"))
            for event in run(plan, rig, writer, lambda: interrupts.pause_requested):
                if isinstance(event, Paused):
                    return False
                report(Progress(f"capture {info.object_id}", event.step.step + 1, len(plan), _live_line(event)))
            writer.close(_lights(folder), version=litrig_version(), instruments=_instruments(config), started=started)
    return True


def _needed(plan: Plan, config: RigConfig) -> frozenset[str]:
    """Name the parts that a plan uses; the others are not touched, and cannot fail."""
    steps = list(plan)
    parts = {"camera"}
    if any(step.angle_deg is not None for step in steps):
        parts.add("turntable")
    if any(step.aim is not None for step in steps):
        has_dome = config.lights is not None and config.lights.directions_deg
        parts |= {"lights"} if has_dome else {"arm", "lights"}
    return frozenset(parts)


def _resolved(config: RigConfig, plan: Plan, info: SessionInfo, started: str) -> Mapping[str, Any]:
    return {
        "session": {
            "object": info.object_id,
            "tangent_zero_deg": info.tangent_zero_deg,
            "started": started,
            "litrig": litrig_version(),
        },
        "plan": plan.parameters(),
        "rig": config.model_dump(exclude_none=True),
    }


def _lights(folder: Path) -> Lights | None:
    frames = [
        entry
        for entry in good_frames(read_journal(folder / layout.JOURNAL))
        if entry["role"] == Role.FRAME and "light" in entry
    ]
    if not frames:
        return None
    names = tuple(Path(entry["file"]).name for entry in frames)
    return Lights(names, np.array([entry["light"] for entry in frames]))


def _instruments(config: RigConfig) -> list[str]:
    sections = (config.turntable, config.arm, config.lights, config.camera)
    return [section.instrument for section in sections if section is not None and section.instrument]


def _live_line(event: FrameTaken) -> str:
    quality = event.quality
    return (
        f"mean {quality.mean:.2f}  clipped {100 * quality.clipped:.1f} %  sharp {quality.sharpness:.4f}  "
        f"pose ±{event.pose_error_deg:.2f}°"
    )
