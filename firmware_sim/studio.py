"""The process that takes the pictures: it asks where the devices were, and renders what the camera saw.

It is apart from the wires, so that a servo answers in time while a picture is computed.
"""

import argparse
import os
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from firmware_sim.camera.encode import encode
from firmware_sim.camera.shared_frame import LONGEST_LAG, SharedFrame, Wish
from firmware_sim.child import Requests, wait_for_the_parent
from firmware_sim.clock import Clock, monotonic_s
from firmware_sim.config import CameraSim, ReliefScene, SimConfig
from firmware_sim.errors import SideChannelError
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.parent import die_with_parent
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import F32, Pose, Scene, Size
from firmware_sim.scene.relief import Relief
from firmware_sim.scene.rendered import RenderedScene
from firmware_sim.scene.rendering import frame_cache, relevance_of
from firmware_sim.scene.sensor import NEUTRAL_K, AutoExposure, Exposure, Sensor
from firmware_sim.side_channel import SideChannel
from firmware_sim.stale import StaleFrames

INSTANTS = 4
"""Instants of an exposure that a moving picture is the mean of."""
AUTO_EXPOSURE = 3
BLUR_PX_A_STEP = 0.08
"""Blur of a picture of 480 rows, for each step of the focus control off the best."""
NAP_S = 0.004
ASK_S = 1.0
READOUT_S = 0.002
CONTROL_UNIT_S = 1e-4


class Shot(NamedTuple):
    """One exposure that is over: when it began, how long it was, what the client had asked for."""

    start_s: float
    time_s: float
    wish: Wish

    @property
    def size(self) -> Size:
        return self.wish.height, self.wish.width

    @property
    def instants_s(self) -> list[float]:
        return [self.start_s + self.time_s * (i + 0.5) / INSTANTS for i in range(INSTANTS)]


class Studio:
    """Renders one exposure after the other for as long as the client streams.

    Parameters
    ----------
    config : the camera
    scene : what it sees
    shared : where pictures go, and wishes come from
    channel : tells where the devices were
    clock : the time that pictures are stamped with
    wait : lets seconds pass
    is_held : whether a client has the camera; one that was killed has not said that it wants no more pictures
    """

    def __init__(
        self,
        config: CameraSim,
        scene: Scene,
        shared: SharedFrame,
        channel: Requests,
        clock: Clock = monotonic_s,
        wait: Callable[[float], None] = wait_for_the_parent,
        is_held: Callable[[], bool] = lambda: True,
    ) -> None:
        self._config = config
        self._shared = shared
        self._channel = channel
        self._clock = clock
        self._wait = wait
        self._is_held, self._asked_s = is_held, clock()
        self._scene = scene
        self._sensor = Sensor(config.full_well_electrons, config.read_noise_electrons, config.seed)
        self._auto = AutoExposure()
        self._last: tuple[object, F32] | None = None
        self._picture = b""
        self._taken: deque[bytes] = deque(maxlen=LONGEST_LAG + 1)
        self._number = 0
        self._next_s = 0.0
        self._period_s = 0.0
        self._stream, self._stamp_s = 0, 0.0
        self._stale = StaleFrames()

    def warm_up(self) -> None:
        """Compute once what all pictures share, before anybody waits for it."""
        pose = self._poses([self._clock()])[0]
        self._scene.light([pose], (self._config.height, self._config.width))

    def work(self) -> None:
        """Take the next picture, or find out that nobody wants one; returns within an exposure or two."""
        if not self._shared["streaming"] or self._shared["unplugged"] or self._shared["hang"]:
            self._wait(NAP_S)
            return
        if self._clock() - self._asked_s > ASK_S:
            self._asked_s = self._clock()
            if not self._is_held():
                self._shared["streaming"] = 0
                return
        shot = self._begin()
        self._wait_until(shot.start_s + shot.time_s + READOUT_S)
        poses = self._poses(shot.instants_s)
        if len(set(poses)) > 1:
            self._publish(shot, poses)
        elif self._scene.is_ready(poses[0], shot.size):
            self._publish(shot, poses[:1])
        else:
            self._publish_stale(shot, poses[0])

    def _publish_stale(self, shot: Shot, pose: Pose) -> None:
        """Keep the client waiting with a picture in between, dated back so that it does not pass for the present."""
        if self._stale.is_due(shot.start_s):
            last_s = self._stamp_s if shot.wish.stream == self._stream else None
            episode = pose, shot.wish.stream
            self._hand_over(shot, [pose, pose], self._stale.stamp_s(episode, last_s, lambda: self._before_rest_s(shot)))

    def _publish(self, shot: Shot, poses: list[Pose]) -> None:
        self._stale = StaleFrames()
        self._hand_over(shot, poses, shot.start_s)

    def _hand_over(self, shot: Shot, poses: list[Pose], stamp_s: float) -> None:
        picture = self._spoil(self._take(shot, poses))
        self._number += 1
        self._stream, self._stamp_s = shot.wish.stream, stamp_s
        self._shared.publish(picture, shot.wish.stream, self._number, stamp_s)

    def _spoil(self, picture: bytes) -> bytes:
        """Hand over what was taken some frames ago instead, or not all of it, if the camera is to do so."""
        self._taken.append(picture)
        late = self._taken[max(0, len(self._taken) - 1 - self._shared["lag_frames"])]
        return late[: len(late) - round(len(late) * self._shared["lost_percent"] / 100)]

    def _begin(self) -> Shot:
        """Wait for the shutter, and only then look what the client wants: a control set before it counts."""
        # Exposures go on while pictures are computed; only one that lags a whole period behind is skipped.
        start_s = max(self._next_s, self._clock() - self._period_s)
        self._wait_until(start_s)
        wish = self._shared.wish()
        automatic = wish.exposure_auto == AUTO_EXPOSURE
        time_s = self._auto.time_s if automatic else wish.exposure_100us * CONTROL_UNIT_S
        self._period_s = max(1 / wish.fps, time_s)
        self._next_s = start_s + self._period_s
        return Shot(start_s, time_s, wish)

    def _wait_until(self, time_s: float) -> None:
        while (left_s := time_s - self._clock()) > 0:
            self._wait(left_s)

    def _take(self, shot: Shot, poses: list[Pose]) -> bytes:
        if self._shared["frozen"] and self._picture:
            return self._picture
        wish = shot.wish
        light = self._light(shot, poses)
        if wish.exposure_auto == AUTO_EXPOSURE:
            self._auto.observe(light, 1 / wish.fps)
        white_balance_k = NEUTRAL_K if wish.white_balance_auto else wish.white_balance_k
        exposure = Exposure(shot.time_s, wish.gain, white_balance_k, wish.brightness)
        camera = self._config
        picture = self._sensor.expose(light, exposure)
        self._picture = encode(picture, wish.pixel_format, camera.jpeg_quality, camera.jpeg_subsampling)
        return self._picture

    def _light(self, shot: Shot, poses: list[Pose]) -> F32:
        off_focus = 0 if shot.wish.focus_auto else abs(shot.wish.focus - self._config.best_focus)
        key = (poses, shot.size, off_focus)
        if self._last is None or self._last[0] != key:
            self._last = key, _defocus(self._scene.light(poses, shot.size), off_focus)
        return self._last[1]

    def _poses(self, times_s: list[float]) -> list[Pose]:
        return [Pose.from_json(values) for values in self._channel.request("poses", at=times_s)["poses"]]

    def _before_rest_s(self, shot: Shot) -> float:
        return float(self._channel.request("poses.before", at=shot.instants_s[0])["time_s"])


def _defocus(light: F32, off_focus: int) -> F32:
    sigma_px = off_focus * BLUR_PX_A_STEP * light.shape[0] / 480
    return np.asarray(cv2.GaussianBlur(light, (0, 0), sigma_px), np.float32) if sigma_px > 0.1 else light


def _scene(config: SimConfig, variant: str, cache: Path, channel: Requests) -> Scene:
    scene = config.scene
    if isinstance(scene, MitsubaScene):
        return RenderedScene(
            frame_cache(scene, variant, cache),
            relevance_of(scene),
            lambda pose, size: channel.request("render.urgent", pose=pose[:4], size=size),
            monotonic_s,
        )
    return Relief(scene) if isinstance(scene, ReliefScene) else BrushedSphere(scene)


def main() -> None:
    """Serve the camera of one simulator until that ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("config", "frames", "channel", "cache"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--variant", default="")
    arguments = parser.parse_args()
    die_with_parent()
    os.nice(10)  # the wires come first
    cv2.setNumThreads(1)
    config = SimConfig.model_validate_json(arguments.config.read_text("utf-8"))
    try:
        with SharedFrame(arguments.frames) as shared, SideChannel(arguments.channel) as channel:
            scene = _scene(config, arguments.variant, arguments.cache, channel)
            studio = Studio(config.camera, scene, shared, channel, is_held=shared.is_held)
            studio.warm_up()
            while True:
                studio.work()
    except SideChannelError:
        raise SystemExit(0) from None  # the simulator has gone, and its camera with it


if __name__ == "__main__":
    main()
