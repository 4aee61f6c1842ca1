"""What a run tells of itself; commands draw it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from acquisition.plans import Step
from acquisition.quality import Quality


@dataclass(frozen=True)
class FrameTaken:
    """A frame is on the disk and counts.

    Attributes
    ----------
    times_s : how long move, settle, expose and save took
    """

    step: Step
    file: str
    quality: Quality
    pose_error_deg: float
    times_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Retried:
    """A frame was of no use, or the camera was lost for a moment; the step is shot again."""

    step: Step
    attempt: int
    reason: str


@dataclass(frozen=True)
class Paused:
    """The operator asked for a pause; the rig stays where it is."""

    frames: int


RunEvent = FrameTaken | Retried | Paused
