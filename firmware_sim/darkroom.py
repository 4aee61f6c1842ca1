"""The process that renders pictures and puts them into the cache, as the server's queue asks.

It is apart from the camera, which goes on while this one computes for seconds, and from the wires. A crash of the
renderer, be it an abort in a library, ends this process alone.
"""

import argparse
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from firmware_sim.child import Requests, wait_for_the_parent
from firmware_sim.config import SimConfig
from firmware_sim.errors import RenderError, SideChannelError
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.parent import die_with_parent
from firmware_sim.scene.coarse import CoarseRenderer
from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.rendered import FrameRenderer
from firmware_sim.scene.rendering import frame_cache, is_slow
from firmware_sim.side_channel import SideChannel

NAP_S = 0.03


class Darkroom:
    """Renders what is asked for and not there yet.

    Parameters
    ----------
    channel : tells what is asked for
    cache : where pictures go
    make_renderer : called when the first one has to be rendered
    """

    def __init__(self, channel: Requests, cache: FrameCache, make_renderer: Callable[[], FrameRenderer]) -> None:
        self._channel = channel
        self._cache = cache
        self._make_renderer = make_renderer
        self._renderer: FrameRenderer | None = None

    def work(self) -> bool:
        """See to the next picture; returns whether there was one to see to."""
        job = self._channel.request("render.next")["job"]
        if job is None:
            return False
        pose, size = Pose.from_json(job[0]), (job[1][0], job[1][1])
        if self._cache.load(pose, size) is None:
            self._cache.store(pose, size, self._render(pose, size))
        self._channel.request("render.finished", pose=pose[:4], size=size)
        return True

    def _render(self, pose: Pose, size: Size) -> F32:
        if self._renderer is None:
            self._renderer = self._make_renderer()
        frame = self._renderer.render(pose, size)
        if frame.shape != (*size, 3) or not np.isfinite(frame).all():
            raise RenderError(f"the renderer gave no picture of {size[1]} × {size[0]} at {pose}; look at the scene")
        return frame


def serve(darkroom: Darkroom, channel: Requests, wait: Callable[[float], None] = wait_for_the_parent) -> None:
    """Work until the simulator ends; what fails is told, and raised.

    Raises
    ------
    SideChannelError
        The simulator has gone.
    """
    try:
        while True:
            wait(0.0 if darkroom.work() else NAP_S)
    except SideChannelError:
        raise
    except Exception as error:
        channel.request("render.failed", reason=f"{error or type(error).__name__}")
        raise


def _mitsuba(scene: MitsubaScene, variant: str) -> FrameRenderer:
    # It takes a while to load, and is not needed at all if every picture is in the cache.
    from firmware_sim.mitsuba.renderer import MitsubaRenderer

    if is_slow(variant):
        return CoarseRenderer(scene, lambda coarse: MitsubaRenderer(coarse, variant))
    return MitsubaRenderer(scene, variant)


def main() -> None:
    """Render for one simulator until that ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("config", "channel", "cache"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--variant", required=True)
    arguments = parser.parse_args()
    die_with_parent()
    os.nice(15)  # after the wires and the camera
    scene = SimConfig.model_validate_json(arguments.config.read_text("utf-8")).scene
    if not isinstance(scene, MitsubaScene):
        raise SystemExit("nothing to render in this scene")
    cache = frame_cache(scene, arguments.variant, arguments.cache)
    try:
        with SideChannel(arguments.channel) as channel:
            serve(Darkroom(channel, cache, lambda: _mitsuba(scene, arguments.variant)), channel)
    except SideChannelError:
        raise SystemExit(0) from None  # the simulator has gone


if __name__ == "__main__":
    main()
