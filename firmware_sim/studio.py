"""The process that takes the pictures: it asks where the devices were, and renders what the camera saw.

It is apart from the wires, so that a servo answers in time while a picture is computed.
"""

import argparse
import os
import select
import sys
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from firmware_sim.camera.encode import encode
from firmware_sim.camera.shared_frame import SharedFrame, Wish
from firmware_sim.clock import Clock, monotonic_s
from firmware_sim.config import ReliefScene, SimConfig
from firmware_sim.errors import SideChannelError
from firmware_sim.parent import die_with_parent
from firmware_sim.scene.brushed_sphere import BrushedSphere
from firmware_sim.scene.pose import F32, Pose, Scene
from firmware_sim.scene.relief import Relief
from firmware_sim.scene.sensor import NEUTRAL_K, AutoExposure, Exposure, Sensor
from firmware_sim.side_channel import SideChannel

INSTANTS = 4
"""Instants of an exposure that a moving picture is the mean of."""
AUTO_EXPOSURE = 3
BLUR_PX_A_STEP = 0.08
"""Blur of a picture of 480 rows, for each step of the focus control off the best."""
NAP_S = 0.004
READOUT_S = 0.002
CONTROL_UNIT_S = 1e-4


class Shot(NamedTuple):
    """One exposure that is over: when it began, how long it was, what the client had asked for."""

    start_s: float
    time_s: float
    wish: Wish


class Studio:
    """Renders one exposure after the other for as long as the client streams."""

    def __init__(self, config: SimConfig, shared: SharedFrame, channel: SideChannel, clock: Clock) -> None:
        camera = config.camera
        self._config = camera
        self._shared = shared
        self._channel = channel
        self._clock = clock
        self._scene: Scene = (
            Relief(config.scene) if isinstance(config.scene, ReliefScene) else BrushedSphere(config.scene)
        )
        self._sensor = Sensor(camera.full_well_electrons, camera.read_noise_electrons, camera.seed)
        self._auto = AutoExposure()
        self._last: tuple[object, F32] | None = None
        self._picture = b""
        self._number = 0
        self._next_s = 0.0
        self._period_s = 0.0

    def warm_up(self) -> None:
        """Compute once what all pictures share, before anybody waits for it."""
        pose = self._poses([self._clock()])[0]
        self._scene.light([pose], (self._config.height, self._config.width))

    def work(self) -> None:
        """Take the next picture, or find out that nobody wants one; returns within an exposure or two."""
        if not self._shared["streaming"] or self._shared["unplugged"] or self._shared["hang"]:
            _wait(NAP_S)
            return
        shot = self._begin()
        self._wait_until(shot.start_s + shot.time_s + READOUT_S)
        picture = self._take(shot)
        self._number += 1
        self._shared.publish(picture, shot.wish.stream, self._number, shot.start_s)

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
            _wait(left_s)

    def _take(self, shot: Shot) -> bytes:
        if self._shared["frozen"] and self._picture:
            return self._picture
        wish = shot.wish
        light = self._light(shot)
        if wish.exposure_auto == AUTO_EXPOSURE:
            self._auto.observe(light, 1 / wish.fps)
        white_balance_k = NEUTRAL_K if wish.white_balance_auto else wish.white_balance_k
        exposure = Exposure(shot.time_s, wish.gain, white_balance_k, wish.brightness)
        camera = self._config
        picture = self._sensor.expose(light, exposure)
        self._picture = encode(picture, wish.pixel_format, camera.jpeg_quality, camera.jpeg_subsampling)
        return self._picture

    def _light(self, shot: Shot) -> F32:
        wish = shot.wish
        size = (wish.height, wish.width)
        off_focus = 0 if wish.focus_auto else abs(wish.focus - self._config.best_focus)
        instants = [shot.start_s + shot.time_s * (i + 0.5) / INSTANTS for i in range(INSTANTS)]
        poses = self._poses(instants)
        if len(set(poses)) == 1:
            poses = poses[:1]
        key = (poses, size, off_focus)
        if self._last is None or self._last[0] != key:
            self._last = key, _defocus(self._scene.light(poses, size), off_focus)
        return self._last[1]

    def _poses(self, times_s: list[float]) -> list[Pose]:
        return [Pose(*values) for values in self._channel.request("poses", at=times_s)["poses"]]


def _defocus(light: F32, off_focus: int) -> F32:
    sigma_px = off_focus * BLUR_PX_A_STEP * light.shape[0] / 480
    return np.asarray(cv2.GaussianBlur(light, (0, 0), sigma_px), np.float32) if sigma_px > 0.1 else light


def _wait(seconds: float) -> None:
    """Let time pass, but not beyond the parent's end: it holds the other end of our standard input."""
    readable, _, _ = select.select([sys.stdin], [], [], seconds)
    if readable:
        raise SystemExit(0)


def main() -> None:
    """Serve the camera of one simulator until that ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("config", "frames", "channel"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    arguments = parser.parse_args()
    die_with_parent()
    os.nice(10)  # the wires come first
    cv2.setNumThreads(1)
    config = SimConfig.model_validate_json(arguments.config.read_text("utf-8"))
    try:
        with SharedFrame(arguments.frames) as shared, SideChannel(arguments.channel) as channel:
            studio = Studio(config, shared, channel, monotonic_s)
            studio.warm_up()
            while True:
                studio.work()
    except SideChannelError:
        raise SystemExit(0) from None  # the simulator has gone, and its camera with it


if __name__ == "__main__":
    main()
