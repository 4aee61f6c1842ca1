"""Sessions written line by line, in any state."""

from pathlib import Path
from typing import Any, Self

import numpy as np
import simplejpeg

from acquisition.plans import Step
from litrig.base.capture_folder.crate import Description
from litrig.base.capture_folder.writer import CaptureFolderWriter, make_thumbnail
from litrig.base.directions import direction_from_angles

SETTINGS: dict[str, Any] = {
    "session": {"object": "coin", "operator": "A. Smith", "litrig": "0.1.0"},
    "plan": {"kind": "amc", "slices": 8},
    "instruments": ["turntable XL430-W250, serial number 17"],
    "rig": {"turntable": {"tolerance_deg": 0.3}, "arm": {"tolerance_deg": 0.2}},
}


class Written:
    """A session under the pen."""

    def __init__(self, folder: Path, steps: list[Step], settings: dict[str, Any] | None = None) -> None:
        self.folder, self.steps = folder, steps
        plan = (step.as_json() for step in steps)
        self.writer = CaptureFolderWriter.create(folder, "coin", settings or SETTINGS, plan)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.__exit__()

    def shoot(self, step: Step, level: int = 120, **fields: Any) -> None:
        """Acknowledge a frame that stood a tenth of a degree off."""
        codes = np.full((12, 16, 3), level, np.uint8)
        content = bytes(simplejpeg.encode_jpeg(codes, 95))
        goal: dict[str, float] = {} if step.angle_deg is None else {"angle_deg": step.angle_deg}
        found = {key: value + 0.1 for key, value in goal.items()}
        line: dict[str, Any] = {
            "step": step.step,
            "try": 1,
            "role": step.role.value,
            "checks": {"mean": level / 255, "light": 0.2, "clipped": 0.0, "sharpness": 0.01, "same_as_previous": False},
            "verdict": "good",
        }
        if step.aim is not None:
            aim = {"azimuth_deg": step.aim.azimuth_deg, "elevation_deg": step.aim.elevation_deg}
            goal, found = {**goal, **aim}, {**found, **aim}
            line["light"] = [float(c) for c in direction_from_angles(*aim.values())]
        line |= {"pose_goal": goal, "pose_before": goal, "pose_after": found, **fields}
        self.writer.add_frame(self.writer.unused_name(step.stem, ".jpg"), content, make_thumbnail(codes), **line)

    def shoot_all(self, *but: int) -> None:
        for step in self.steps:
            if step.step not in but:
                self.shoot(step)

    def close(self) -> None:
        self.writer.close(None, Description("0.1.0", "2026-11-26T12:00:00+00:00"))


def turn(slices: int) -> list[Step]:
    return [Step(index, angle_deg=360 * index / slices) for index in range(slices)]
