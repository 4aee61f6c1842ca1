"""Rendered pictures for machines that would take minutes for a whole one."""

from collections.abc import Callable
from typing import NamedTuple

import cv2
import numpy as np

from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.rendered import FrameRenderer


class Economy(NamedTuple):
    """How much less is rendered: one pixel for so many along each side, and at most so many paths a pixel."""

    shrink: int
    most_samples: int


SCALAR_ECONOMY = Economy(shrink=4, most_samples=16)


class CoarseRenderer:
    """Fits `FrameRenderer`; renders small pictures with few paths, and enlarges them.

    Parameters
    ----------
    scene : what to render
    make_renderer : makes the renderer of a scene
    economy : what is saved
    """

    def __init__(
        self,
        scene: MitsubaScene,
        make_renderer: Callable[[MitsubaScene], FrameRenderer],
        economy: Economy = SCALAR_ECONOMY,
    ) -> None:
        samples = min(scene.samples, economy.most_samples)
        self._renderer = make_renderer(scene.model_copy(update={"samples": samples}))
        self._shrink = economy.shrink

    def render(self, pose: Pose, size: Size) -> F32:
        """Render at a fraction of the size, and enlarge."""
        small: Size = (max(1, size[0] // self._shrink), max(1, size[1] // self._shrink))
        light = self._renderer.render(pose, small)
        enlarged = cv2.resize(light, (size[1], size[0]), interpolation=cv2.INTER_LINEAR)
        return np.asarray(enlarged, np.float32)
