"""What the earlier parts of a session tell the next one."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from acquisition.plans import Step
from acquisition.revisit import Revisits
from acquisition.runner import SoFar
from litrig.base.capture_folder.capture import Role
from litrig.base.capture_folder.journal import Entry
from litrig.base.capture_folder.reader import good_frames
from litrig.base.errors import LitrigError
from litrig.base.files import resolve_inside
from litrig.base.pictures import decode_codes
from rig.config import RigConfig

_LOOKED_AT = 12
"""So many of the first frames are looked at, to find the first of a turn and one beside it."""


def so_far(
    folder: Path, wanted: Sequence[Step], entries: Sequence[Entry], config: RigConfig, *, forget_settings: bool
) -> SoFar:
    """Gather it from the journal and the first frames.

    Parameters
    ----------
    forget_settings : a new segment begins, in which the camera may be set otherwise
    """
    frames = good_frames(entries)
    result = SoFar()
    if not forget_settings:
        result.settings = {float(entry.get("exposure_ev", 0.0)): entry.get("camera", {}) for entry in frames}
    result.since_revisit = _since_revisit(entries, {entry["step"] for entry in frames})
    result.revisits = Revisits(0.0 if config.turntable is None else config.turntable.tolerance_deg)
    steps = {step.step: step for step in wanted}
    turned = [entry for entry in frames if entry.get("role") == Role.FRAME and "angle_deg" in entry["pose_after"]]
    for entry in turned[:_LOOKED_AT]:
        if step := steps.get(entry["step"]):
            _look(folder, step, entry, result.revisits)
    return result


def _since_revisit(entries: Sequence[Entry], good: set[int]) -> list[int]:
    since: list[int] = []
    for entry in entries:
        if entry["ev"] == "frame" and entry.get("role") == Role.CLOSURE:
            since.clear()
        elif entry["ev"] == "frame" and entry["step"] in good:
            since.append(entry["step"])
    return since


def _look(folder: Path, step: Step, entry: Entry, revisits: Revisits) -> None:
    path = resolve_inside(folder, entry["file"])
    with suppress(LitrigError, OSError):  # a damaged frame is shot again anyway
        codes = np.asarray(decode_codes(path.read_bytes(), path.suffix, str(path)), np.uint8)
        revisits.watch(step, entry["pose_after"]["angle_deg"], codes)
