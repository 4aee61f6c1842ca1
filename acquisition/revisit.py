"""Has the table slipped, or the sample moved? A frame of the first pose, shot again, is held against the first one.

For small turns the picture changes in proportion to the angle, so that how much it changes from the first frame to the
one beside it is a ruler: the change that a closure frame shows, laid along it, is the slip in degrees. A change that is
larger than that from frame to frame, whatever its kind, means that the frames do not belong together any more.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from acquisition.plans import Step
from litrig.base.capture_folder.capture import Role
from litrig.base.radiometry import U8

F32 = NDArray[np.float32]

WIDTH_PX = 320
SIGNIFICANT = 4.0
"""A slip or change below so many standard deviations of the noise is none."""
MOST_CHANGED = 0.1
"""Without a frame beside it: the change of a closure frame, relative to the frame."""
NEAR_DEG = 1e-6
SAME_POSE_DEG = 0.1
FARTHEST_DEG = 90.0
"""How far the frame beside may be, for its change to be a ruler."""


@dataclass(frozen=True)
class _Seen:
    step: Step
    angle_deg: float
    grey: F32


class Revisits:
    """Watches the frames go by, and judges those of role closure.

    Parameters
    ----------
    tolerance_deg : how far the table may be off its pose
    """

    def __init__(self, tolerance_deg: float) -> None:
        self._tolerance_deg = tolerance_deg
        self._first: _Seen | None = None
        self._beside: _Seen | None = None

    def watch(self, step: Step, angle_deg: float | None, codes: U8) -> None:
        """Remember a frame if it is the first of the turn, or the one beside it.

        Parameters
        ----------
        angle_deg : read back
        codes : (H, W, 3) uint8
        """
        if step.role is not Role.FRAME or angle_deg is None or self._beside is not None:
            return
        seen = _Seen(step, angle_deg, _grey(codes))
        if self._first is None:
            self._first = seen
        elif _alike(step, self._first.step) and SAME_POSE_DEG < abs(angle_deg - self._first.angle_deg) < FARTHEST_DEG:
            self._beside = seen

    def judge(self, step: Step, angle_deg: float | None, codes: U8) -> str:
        """Say what is wrong with a frame of role closure; empty if nothing is, or if nothing can be said."""
        first = self._first
        if step.role is not Role.CLOSURE or first is None or angle_deg is None or step.angle_deg is None:
            return ""
        if not _alike(step, first.step) or abs(_turn(step.angle_deg - (first.step.angle_deg or 0.0))) > NEAR_DEG:
            return ""
        change = _grey(codes) - first.grey
        noise = _noise(change)
        size = float(np.sqrt(np.mean(change**2)))
        if size < SIGNIFICANT * noise:
            return ""
        share = size / max(float(np.sqrt(np.mean(first.grey**2))), 1e-6)
        differs = f"differs from the first at its pose by {100 * share:.0f} %"
        if self._beside is None:
            return "" if share < MOST_CHANGED else differs
        between_deg = self._beside.angle_deg - first.angle_deg
        ruler = (self._beside.grey - first.grey) / between_deg
        length = float(np.sum(ruler**2))
        slip_deg = float(np.sum(change * ruler)) / length - _turn(angle_deg - first.angle_deg)
        doubt_deg = noise / float(np.sqrt(length))
        if abs(slip_deg) > max(self._tolerance_deg, SIGNIFICANT * doubt_deg):
            return f"shows the sample {slip_deg:+.1f}° from where it stood in the first at its pose"
        is_farther = size > abs(between_deg) * float(np.sqrt(length / change.size))
        return differs if is_farther and share > MOST_CHANGED else ""


def _alike(step: Step, other: Step) -> bool:
    return (step.aim, step.exposure_ev, step.lit) == (other.aim, other.exposure_ev, other.lit)


def _turn(angle_deg: float) -> float:
    """Bring an angle to −180..180."""
    return (angle_deg + 180) % 360 - 180


def _grey(codes: U8) -> F32:
    height = max(1, round(codes.shape[0] * WIDTH_PX / codes.shape[1]))
    small = cv2.resize(codes, (WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small.mean(axis=-1, dtype=np.float32) / 255, np.float32)


def _noise(change: F32) -> float:
    """Estimate the noise of a difference from its finest grain (median of the second difference along rows)."""
    second = change[:, 2:] - 2 * change[:, 1:-1] + change[:, :-2]
    return float(np.median(np.abs(second))) / (0.6745 * math.sqrt(6))
