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
from litrig.base.directions import turn_between_deg
from litrig.base.radiometry import U8

F32 = NDArray[np.float32]

WIDTH_PX = 160
"""Pictures are compared at this width: what a slip changes is large, and the noise is less."""
SIGNIFICANT = 6.0
"""A slip below so many standard deviations is none; they are of noise without correlation, which JPEG's is not."""
MOST_CHANGED = 0.1
"""Without a frame beside it: the change of a closure frame, relative to the frame."""
MOST_OTHERWISE, OTHERWISE = 0.05, 4.0
"""With one: a change of another kind, relative to the frame, and to the change that the least slip makes."""
NEAR_DEG = 1e-6
ENOUGH_DEG = 5.0
"""A frame that is nearer to the first makes a ruler only until another one comes."""
SAME_POSE_DEG = 0.1
UNLIKE = 8.0
"""A change is no slip if it is so many times (squared) what the slip would make."""
STRAIGHT_DEG = 15.0
"""A ruler that is so long may be off by half."""
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
        if step.role is not Role.FRAME or angle_deg is None or self._has_ruler:
            return
        if self._first is None:
            self._first = _Seen(step, angle_deg, _grey(codes))
        elif _alike(step, self._first.step) and SAME_POSE_DEG < abs(angle_deg - self._first.angle_deg) < FARTHEST_DEG:
            self._beside = _Seen(step, angle_deg, _grey(codes))

    @property
    def _has_ruler(self) -> bool:
        if self._first is None or self._beside is None:
            return False
        return abs(self._beside.angle_deg - self._first.angle_deg) >= ENOUGH_DEG

    def judge(self, step: Step, angle_deg: float | None, codes: U8) -> str:
        """Say what is wrong with a frame of role closure; empty if nothing is, or if nothing can be said."""
        first = self._first
        if step.role is not Role.CLOSURE or first is None or angle_deg is None or step.angle_deg is None:
            return ""
        if (
            not _alike(step, first.step)
            or abs(turn_between_deg(step.angle_deg, first.step.angle_deg or 0.0)) > NEAR_DEG
        ):
            return ""
        change = _grey(codes) - first.grey
        variance = _noise(change) ** 2
        size = float(np.mean(change**2)) - variance
        share = math.sqrt(max(size, 0.0)) / max(float(np.sqrt(np.mean(first.grey**2))), 1e-6)
        differs = f"differs from the first at its pose by {100 * share:.0f} %"
        if self._beside is None:
            return differs if size > variance and share > MOST_CHANGED else ""
        return self._against_ruler(
            first, self._beside, change, variance, turn_between_deg(angle_deg, first.angle_deg)
        ) or (differs if size > variance and share > 1 else "")

    def _against_ruler(self, first: _Seen, beside: _Seen, change: F32, variance: float, turned_deg: float) -> str:
        """Lay a change along that from the first frame to the one beside it.

        The noise of the first frame is in both, and that of both frames makes the ruler seem longer than it is: what
        they add on the average is taken off.

        Parameters
        ----------
        variance : of the noise of a difference of two frames
        turned_deg : how far the table reads that it stands from where it stood in the first frame
        """
        between_deg, count = beside.angle_deg - first.angle_deg, change.size
        ruler = (beside.grey - first.grey) / between_deg
        length = float(np.sum(ruler**2)) - count * variance / between_deg**2
        doubt_deg = math.sqrt(variance / length) if length > 0 else math.inf
        # What the table is off by its own word is laid along the same ruler: a chord, the worse the longer it is.
        crooked_deg = abs(turned_deg) * (1 + abs(between_deg) / STRAIGHT_DEG)
        least_deg = max(self._tolerance_deg, SIGNIFICANT * doubt_deg) + crooked_deg
        if not least_deg < FARTHEST_DEG:
            return ""
        along = (float(np.sum(change * ruler)) - count * variance / (2 * between_deg)) / length
        rest = float(np.sum((change - turned_deg * ruler) ** 2)) - count * variance
        share = math.sqrt(max(rest, 0.0) / max(float(np.sum(first.grey**2)), 1e-6))
        differs = f"differs from the first at its pose by {100 * share:.0f} %"
        slip_deg = along - turned_deg
        if abs(slip_deg) > least_deg:
            # A change that is mostly of another kind is no slip, whatever it makes along the ruler.
            is_slip = rest < UNLIKE * slip_deg**2 * length
            return (
                f"shows the sample {slip_deg:+.1f}° from where it stood in the first at its pose"
                if is_slip
                else differs
            )
        is_large = rest > max(count * variance, (OTHERWISE * least_deg) ** 2 * length)
        return differs if is_large and share > MOST_OTHERWISE else ""


def _alike(step: Step, other: Step) -> bool:
    return (step.aim, step.exposure_ev, step.lit) == (other.aim, other.exposure_ev, other.lit)


def _grey(codes: U8) -> F32:
    height = max(1, round(codes.shape[0] * WIDTH_PX / codes.shape[1]))
    small = cv2.resize(codes, (WIDTH_PX, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small.mean(axis=-1, dtype=np.float32) / 255, np.float32)


def _noise(change: F32) -> float:
    """Estimate the noise of a difference from its finest grain (median of the second difference along rows)."""
    second = change[:, 2:] - 2 * change[:, 1:-1] + change[:, :-2]
    return float(np.median(np.abs(second))) / (0.6745 * math.sqrt(6))
