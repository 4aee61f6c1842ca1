from pathlib import Path

import numpy as np
import pytest

from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.relevance import Relevance
from firmware_sim.scene.rendered import PATIENCE_S, RenderedScene
from tests.firmware_sim.timing import HandClock

SIZE = (6, 8)
TURNTABLE = Relevance(turntable=True, arm=False)


def level(value: float) -> F32:
    return np.full((*SIZE, 3), value, np.float32)


def turned(angle_deg: float, azimuth_deg: float = 0.0) -> Pose:
    return Pose(angle_deg, azimuth_deg, 0, 1)


class Setup:
    def __init__(self, folder: Path) -> None:
        self.clock = HandClock()
        self.asked: list[tuple[Pose, Size]] = []
        self.cache = FrameCache(folder, "scene", "renderer")
        self.scene = RenderedScene(self.cache, TURNTABLE, lambda *job: self.asked.append(job), self.clock)

    def render(self, angle_deg: float, value: float) -> None:
        self.cache.store(turned(angle_deg), SIZE, level(value))


@pytest.fixture
def setup(tmp_path: Path) -> Setup:
    return Setup(tmp_path)


def test_at_rest_the_picture_is_the_rendered_one(setup: Setup) -> None:
    rendered = np.random.default_rng(1).random((*SIZE, 3)).astype(np.float16).astype(np.float32)
    setup.cache.store(turned(7.031), SIZE, rendered)
    setup.render(8, 900)
    tick_80 = turned(360 + 7.03125, azimuth_deg=77)
    assert setup.scene.is_ready(tick_80, SIZE)
    np.testing.assert_array_equal(setup.scene.light([tick_80], SIZE), rendered)
    assert setup.asked == []


def test_a_tick_beside_is_not_ready(setup: Setup) -> None:
    setup.render(5.625, 1)
    assert not setup.scene.is_ready(turned(5.625 + 360 / 4096), SIZE)


def test_a_picture_that_stays_missing_is_asked_for(setup: Setup) -> None:
    assert not setup.scene.is_ready(turned(370), SIZE)
    assert setup.asked == []
    setup.clock.pass_s(PATIENCE_S)
    assert not setup.scene.is_ready(turned(370), SIZE)
    assert setup.asked == [(turned(10), SIZE)]
    setup.render(10, 1)
    assert setup.scene.is_ready(turned(370), SIZE)


def test_a_pause_is_no_rest(setup: Setup) -> None:
    for angle_deg in range(5):
        assert not setup.scene.is_ready(turned(angle_deg), SIZE)
        setup.clock.pass_s(PATIENCE_S)
    assert setup.asked == []


def test_in_motion_it_lies_between_the_nearest(setup: Setup) -> None:
    for angle_deg, value in ((0, 1), (10, 2), (20, 9)):
        setup.render(angle_deg, value)
    instants = [turned(angle_deg) for angle_deg in (2, 4, 6)]
    np.testing.assert_allclose(setup.scene.light(instants, SIZE), level(1.4), rtol=1e-6)


def test_where_nothing_is_rendered_it_is_dark(setup: Setup) -> None:
    np.testing.assert_array_equal(setup.scene.light([turned(3)], SIZE), level(0))
    setup.render(50, 2)
    np.testing.assert_array_equal(setup.scene.light([turned(3)], SIZE), level(2))


def test_a_damaged_neighbour_is_left_out(setup: Setup) -> None:
    setup.render(0, 1)
    setup.cache.path(turned(0), SIZE).write_bytes(b"damaged")
    np.testing.assert_array_equal(setup.scene.light([turned(1), turned(2)], SIZE), level(0))
