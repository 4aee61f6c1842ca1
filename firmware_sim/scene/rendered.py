"""A scene whose pictures take longer to compute than to expose: somebody else renders them, here they are shown."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from firmware_sim.clock import Clock
from firmware_sim.scene.between import weights_between
from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.relevance import Relevance, standard

KEPT = 8
"""Pictures that stay in memory: a few neighbours."""
PATIENCE_S = 0.2
"""How long a picture is missing before it is asked for: drivers pause for less where they only turn about."""


class FrameRenderer(Protocol):
    """What computes a picture, however long that takes."""

    def render(self, pose: Pose, size: Size) -> F32:
        """Return what the camera sees in a pose: (H, W, 3) float32, linear RGB, in the unit of `Scene.light`."""


class RenderedScene:
    """Fits `Scene`.

    Parameters
    ----------
    cache : where rendered pictures appear
    relevance : what the pictures depend on
    ask : called with the pose and size of a picture that is missing; it need not wait for it
    clock : to tell a rest from a pause
    """

    def __init__(
        self, cache: FrameCache, relevance: Relevance, ask: Callable[[Pose, Size], object], clock: Clock
    ) -> None:
        self._cache = cache
        self._relevance = relevance
        self._ask = ask
        self._clock = clock
        self._missing: tuple[Pose, Size] | None = None
        self._since_s = 0.0
        self._kept: dict[tuple[Pose, Size], F32] = {}

    def is_ready(self, pose: Pose, size: Size) -> bool:
        """Tell whether `light` of this pose alone would be exact; if that stays untrue, the picture is asked for."""
        wanted = standard(self._relevance.of(pose))
        if self._frame(wanted, size) is not None:
            self._missing = None
            return True
        if self._missing != (wanted, size):
            self._missing, self._since_s = (wanted, size), self._clock()
        if self._clock() - self._since_s >= PATIENCE_S:
            self._ask(wanted, size)
        return False

    def light(self, poses: Sequence[Pose], size: Size) -> F32:
        """Return the rendered picture of one pose, or the mean over a motion, between the nearest that there are.

        Where nothing is rendered yet it is dark.
        """
        exact = self._frame(standard(self._relevance.of(poses[0])), size) if len(poses) == 1 else None
        return self._between(poses, size) if exact is None else exact

    def _between(self, poses: Sequence[Pose], size: Size) -> F32:
        known = self._cache.poses(size)
        shares: dict[Pose, float] = defaultdict(float)
        for pose in map(self._relevance.of, poses):
            for neighbour, weight in weights_between(pose, known, self._relevance).items():
                shares[neighbour] += weight / len(poses)
        mean = np.zeros((*size, 3), np.float32)
        for neighbour, share in shares.items():
            frame = self._frame(neighbour, size)
            if frame is not None:  # it may be damaged, or have been dropped this very moment
                mean += np.float32(share) * frame
        return mean

    def _frame(self, pose: Pose, size: Size) -> F32 | None:
        frame = self._kept.pop((pose, size), None)
        if frame is None:
            frame = self._cache.load(pose, size)
        if frame is not None:
            self._kept[pose, size] = frame  # the latest used comes last
            while len(self._kept) > KEPT:
                del self._kept[next(iter(self._kept))]
        return frame
