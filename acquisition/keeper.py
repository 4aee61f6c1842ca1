"""Looking at frames and writing them, in a thread of its own, while the rig is on its way to the next pose.

One frame at a time: before the next is exposed, the one before must be on the disk, so that no mishap costs more than
one.
"""

import time
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass
from types import TracebackType
from typing import Any, Self

import numpy as np

from acquisition.events import FrameTaken
from acquisition.plans import Step
from acquisition.poses import Poses
from acquisition.quality import Inspector, Quality
from acquisition.revisit import Revisits
from litrig.base.capture_folder.writer import CaptureFolderWriter, make_thumbnail
from litrig.base.directions import direction_from_angles
from litrig.base.errors import FormatError
from rig.devices import Shot


@dataclass(frozen=True)
class Exposed:
    """A picture as it came, and what is known without looking at it.

    Attributes
    ----------
    attempt : from 1
    pose_error_deg : the larger of both
    times_s : how long move, settle and expose took
    """

    step: Step
    attempt: int
    before: Poses
    after: Poses
    shot: Shot
    pose_error_deg: float
    times_s: Mapping[str, float]


@dataclass(frozen=True)
class Rejected:
    """A picture that does not count, and why."""

    exposed: Exposed
    reason: str


@dataclass(frozen=True)
class Kept:
    """A frame that counts, and what it says about those before it (empty if nothing)."""

    taken: FrameTaken
    alarm: str


class Keeper:
    """A context manager, at whose end nothing is under way any more."""

    def __init__(self, writer: CaptureFolderWriter, inspector: Inspector, revisits: Revisits) -> None:
        self._writer, self._inspector, self._revisits = writer, inspector, revisits
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="keeper")
        self._pending: Future[Kept | Rejected] | None = None

    def __enter__(self) -> Self:
        """Be there."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Finish the frame under way."""
        self._thread.shutdown(wait=True)

    @property
    def is_busy(self) -> bool:
        """Whether there is a frame whose fate was not asked for yet."""
        return self._pending is not None

    def keep(self, exposed: Exposed) -> None:
        """Take a picture over; the fate of the one before must have been asked for."""
        assert self._pending is None  # noqa: S101  # the bound of the queue
        self._pending = self._thread.submit(self._keep, exposed)

    def fate(self) -> Kept | Rejected | None:
        """Wait for the picture that was handed over last, and tell what became of it; None if there is none.

        Raises
        ------
        InputError
            It could not be written.
        """
        if self._pending is None:
            return None
        pending, self._pending = self._pending, None
        return pending.result()

    def _keep(self, exposed: Exposed) -> Kept | Rejected:
        step, shot = exposed.step, exposed.shot
        handed_over_s = time.monotonic()
        try:
            codes, quality = self._inspector.inspect(shot.content, shot.ending, "camera")
            reason = self._inspector.fault(step, quality)
        except FormatError as error:
            reason = str(error)
        if reason:
            return Rejected(exposed, reason)
        angle_deg = None if exposed.after.turntable is None else exposed.after.turntable.angle_deg
        alarm = self._revisits.judge(step, angle_deg, codes)
        start_s = time.monotonic()
        name = self._writer.unused_name(step.stem, shot.ending)
        line = {**_line(exposed, quality, alarm), "handed_over_s": round(handed_over_s, 6)}
        entry = self._writer.add_frame(name, shot.content, make_thumbnail(codes), **line)
        self._revisits.watch(step, angle_deg, codes)
        times_s = {**exposed.times_s, "save": time.monotonic() - start_s}
        return Kept(FrameTaken(step, entry["file"], quality, exposed.pose_error_deg, times_s), alarm)


def _line(exposed: Exposed, quality: Quality, alarm: str) -> Mapping[str, Any]:
    step, after, shot = exposed.step, exposed.after, exposed.shot
    goal = {} if step.angle_deg is None else {"angle_deg": step.angle_deg}
    fields: dict[str, Any] = {
        "step": step.step,
        "try": exposed.attempt,
        "role": step.role.value,
        "pose_goal": goal if step.aim is None else {**goal, **asdict(step.aim)},
        "pose_before": exposed.before.as_json(),
        "pose_after": after.as_json(),
    }
    if after.light is not None and step.lit:
        light = direction_from_angles(after.light.azimuth_deg, after.light.elevation_deg)
        fields["light"] = [round(float(component), 6) for component in light / np.linalg.norm(light)]
    if step.exposure_ev:
        fields["exposure_ev"] = step.exposure_ev
    fields["camera"] = dict(shot.settings)
    fields["exposed"] = {"from_s": round(shot.exposed_from_s, 6), "to_s": round(shot.exposed_to_s, 6)}
    fields["times_s"] = {key: round(value, 4) for key, value in exposed.times_s.items()}
    fields["checks"] = quality.as_json()
    if remarks := quality.remarks + ((alarm,) if alarm else ()):
        fields["remarks"] = list(remarks)
    fields["verdict"] = "good"
    return fields
