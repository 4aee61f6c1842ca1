"""The camera's process on a clock of its own, before a rendered scene whose pictures come late."""

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import simplejpeg

from firmware_sim.camera.shared_frame import HEADER_BYTES, MJPG, SharedFrame
from firmware_sim.config import CameraSim
from firmware_sim.resting import last_elsewhere_s
from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.relevance import Relevance
from firmware_sim.scene.rendered import RenderedScene
from firmware_sim.side_channel import Answer
from firmware_sim.studio import Studio
from tests.firmware_sim.timing import HandClock

SIZE: Size = (240, 320)
STARTS_S, RESTS_S = 100.5, 101.0
"""The table turns from 0° to 45° in between, at a steady speed."""
GOAL = Pose(45, 0, 0, 1)
LONGEST_SILENCE_S = 10.0
"""OpenCV gives up when nothing has come for this long."""
MOST_STALE = 200
"""A driver gives up after so many pictures that are too old."""


def level(value: float) -> F32:
    return np.full((*SIZE, 3), value, np.float32)


class Frame(NamedTuple):
    stamp_s: float
    published_s: float
    mean: float


class Stage:
    """A studio, and the table before it."""

    def __init__(self, folder: Path, shared: SharedFrame) -> None:
        self.clock = HandClock()
        self.shared = shared
        self.asked: list[Pose] = []
        self.cache = FrameCache(folder, "scene", "renderer")
        relevance = Relevance(turntable=True, arm=False)
        scene = RenderedScene(self.cache, relevance, lambda pose, size: self.asked.append(pose), self.clock)
        camera = CameraSim(width=320, height=240, read_noise_electrons=0, full_well_electrons=1e8)
        self.studio = Studio(camera, scene, shared, self, self.clock, self.clock.pass_s)

    def request(self, do: str, **parameters: object) -> Answer:
        at = parameters["at"]
        if do == "poses.before":
            assert isinstance(at, float)
            return {"time_s": last_elsewhere_s(self.pose, at)}
        assert isinstance(at, list)
        return {"poses": [self.pose(time_s) for time_s in at]}

    def pose(self, time_s: float) -> Pose:
        way = min(max((time_s - STARTS_S) / (RESTS_S - STARTS_S), 0), 1)
        return Pose(GOAL.turntable_deg * way, 0, 0, 1)

    def run_until(self, time_s: float) -> list[Frame]:
        """Work up to a time; returns what the camera delivered meanwhile."""
        frames = []
        while self.clock() < time_s:
            number = self.shared["number"]
            self.studio.work()
            if int(self.shared["number"]) > number:
                frames.append(self._frame())
        return frames

    def _frame(self) -> Frame:
        content = self.shared._memory[HEADER_BYTES : HEADER_BYTES + self.shared["picture_bytes"]]
        return Frame(
            self.shared["exposure_start_ns"] / 1e9, self.clock(), float(simplejpeg.decode_jpeg(content).mean())
        )


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    with SharedFrame(tmp_path / "frames", create=True) as shared:
        wish = {"streaming": 1, "stream": 1, "pixel_format": MJPG, "width": 320, "height": 240, "fps": 30}
        wish |= {"exposure_auto": 1, "exposure_100us": 100, "white_balance_auto": 1, "focus_auto": 1}
        for name, value in wish.items():
            shared[name] = value
        yield Stage(tmp_path / "cache", shared)


def code(light: float) -> float:
    return 255 * (1.055 * float(light ** (1 / 2.4)) - 0.055)


def test_at_rest_every_frame_is_exact_and_of_its_own_time(stage: Stage) -> None:
    stage.cache.store(Pose(0, 0, 0, 1), SIZE, level(0.3))
    frames = stage.run_until(STARTS_S - 0.1)
    assert len(frames) > 5
    for frame in frames:
        assert frame.mean == pytest.approx(code(0.3), abs=1)
        assert 0 < frame.published_s - frame.stamp_s < 0.05


def test_in_motion_the_picture_goes_over_from_one_to_the_next(stage: Stage) -> None:
    stage.cache.store(Pose(0, 0, 0, 1), SIZE, level(0.1))
    stage.cache.store(GOAL, SIZE, level(0.6))
    stage.run_until(STARTS_S)
    means = [frame.mean for frame in stage.run_until(RESTS_S)]
    assert len(means) > 10
    assert means == sorted(means)
    assert code(0.1) - 1 < means[0] < means[-1] < code(0.6) + 1
    half = min(means, key=lambda mean: abs(mean - code(0.35)))
    assert half == pytest.approx(code(0.35), abs=5)


def test_until_a_picture_is_there_no_frame_can_pass_for_it(stage: Stage) -> None:
    stage.cache.store(Pose(0, 0, 0, 1), SIZE, level(0.1))
    before = stage.run_until(RESTS_S)
    waiting = stage.run_until(RESTS_S + 12)
    stamps = [frame.stamp_s for frame in before + waiting]
    assert max(stamps) < RESTS_S
    assert all(earlier < later for earlier, later in itertools.pairwise(stamps))
    assert stage.asked[0] == GOAL
    stage.cache.store(GOAL, SIZE, level(0.6))
    after = stage.run_until(stage.clock() + 0.3)
    assert min(frame.stamp_s for frame in after) > RESTS_S
    assert [frame.mean for frame in after] == pytest.approx([code(0.6)] * len(after), abs=1)


def test_a_client_that_waits_is_kept_waiting(stage: Stage) -> None:
    frames = stage.run_until(RESTS_S + 15)
    times = [frame.published_s for frame in frames]
    assert max(later - earlier for earlier, later in itertools.pairwise(times)) < LONGEST_SILENCE_S / 5
    assert sum(frame.published_s > RESTS_S for frame in frames) < MOST_STALE / 5


def test_a_camera_opened_before_a_missing_picture_shows_nothing_of_the_present(stage: Stage) -> None:
    stage.shared["streaming"] = 0
    stage.run_until(RESTS_S + 3)
    stage.shared["streaming"], stage.shared["stream"] = 1, 2
    frames = stage.run_until(RESTS_S + 6)
    assert len(frames) > 3
    assert all(frame.stamp_s < RESTS_S for frame in frames)


def test_a_pose_that_was_left_and_reached_again_keeps_times_rising(stage: Stage) -> None:
    first = stage.run_until(STARTS_S - 0.1)  # at 0°, which is not rendered either
    stamps = [frame.stamp_s for frame in first + stage.run_until(RESTS_S + 2)]
    assert all(earlier < later for earlier, later in itertools.pairwise(stamps))
    assert first[-1].stamp_s < 100
