"""A whole simulated rig whose camera sees rendered pictures, with the renderer's process at work."""

import importlib.util
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.config import CameraSim, SimConfig
from firmware_sim.errors import RenderError
from firmware_sim.launch import RunningSim, simulated_rig
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.mitsuba.variants import best_variant
from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import PlannedPose, Pose
from firmware_sim.scene.relevance import standard
from firmware_sim.scene.rendering import frame_cache
from firmware_sim.scene.sensor import Exposure, Sensor
from tests.firmware_sim.conftest import Client
from tests.firmware_sim.ports import turntable_of
from tests.firmware_sim.test_launch import eventually, processes_in

pytestmark = pytest.mark.skipif(importlib.util.find_spec("mitsuba") is None, reason="mitsuba is not installed")

SIZE = (240, 320)
SCENE = MitsubaScene(samples=1)
CONFIG = SimConfig(camera=CameraSim(width=320, height=240), scene=SCENE)
AT_TICK_80, AT_TICK_160 = (standard(Pose(tick * 360 / 4096, 0, 0, 1)) for tick in (80, 160))
LOOK = """
camera = opened()
camera.set(cv2.CAP_PROP_FRAME_WIDTH, 320)
camera.set(cv2.CAP_PROP_FRAME_HEIGHT, 240)
for line in sys.stdin:
    say(picture=fresh(camera)[..., ::-1].reshape(-1, 3).mean(0).tolist())
"""


def cache_in(root: Path) -> FrameCache:
    return frame_cache(SCENE, best_variant(), root)


def paint(root: Path, pose: Pose, light: tuple[float, float, float]) -> None:
    """Put a picture of one colour where a rendered one would be."""
    cache_in(root).store(pose, SIZE, np.full((*SIZE, 3), light, np.float32))


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return tmp_path / "cache"


@pytest.fixture
def sim(tmp_path: Path, root: Path) -> Iterator[RunningSim]:
    with simulated_rig(CONFIG, tmp_path / "sim", root) as running:
        yield running


def darkroom_of(folder: Path) -> int:
    found: list[int] = []

    def is_there() -> bool:
        found[:] = [pid for pid in processes_in(folder) if b"darkroom" in Path(f"/proc/{pid}/cmdline").read_bytes()]
        return len(found) == 1

    assert eventually(is_there)
    return found[0]


def test_the_camera_shows_what_was_rendered_for_the_pose_at_rest(sim: RunningSim, root: Path) -> None:
    red, green = (0.6, 0.05, 0.05), (0.05, 0.6, 0.05)
    paint(root, AT_TICK_80, red)
    paint(root, AT_TICK_160, green)
    with turntable_of(sim) as table, Client(sim).talk(LOOK) as talk:
        table.prepare()
        for counts, brightest in ((80, 0), (160, 1), (80, 0)):
            table.go(counts)
            talk.tell()
            picture = talk.hear()["picture"]
            assert np.argmax(picture) == brightest
            assert max(picture) == pytest.approx(203, abs=4)  # 0.6 in sRGB


def test_a_pose_that_nobody_announced_is_rendered_when_the_table_stands_there(sim: RunningSim, root: Path) -> None:
    with turntable_of(sim) as table, Client(sim).talk(LOOK) as talk:
        table.prepare()
        table.go(80)
        talk.tell()
        picture = talk.hear()["picture"]
    rendered = cache_in(root).load(AT_TICK_80, SIZE)
    assert rendered is not None
    expected = Sensor(20_000, 6, seed=2).expose(rendered, Exposure(0.01)).reshape(-1, 3).mean(0)
    assert max(expected) > 10
    np.testing.assert_allclose(picture, expected, atol=1)


def test_a_plan_is_rendered_ahead_with_progress_and_only_once(tmp_path: Path, root: Path) -> None:
    stops = [PlannedPose(turntable_deg=7), PlannedPose(turntable_deg=14.1), PlannedPose(turntable_deg=7)]
    written = {}
    for start in ("first", "second"):
        told: list[tuple[int, int]] = []
        with simulated_rig(CONFIG, tmp_path / start, root) as sim:
            sim.render_ahead(stops, lambda done, total, told=told: told.append((done, total)))  # type: ignore[misc]
        assert told[-1] == (2, 2)
        assert told == sorted(set(told))
        written[start] = cache_in(root).path(AT_TICK_80, SIZE).stat().st_ino
    assert sorted(cache_in(root).poses(SIZE)) == [AT_TICK_80, AT_TICK_160]
    assert written["first"] == written["second"]


def test_a_renderer_that_is_killed_is_told_and_the_devices_go_on(sim: RunningSim, tmp_path: Path) -> None:
    os.kill(darkroom_of(tmp_path / "sim"), signal.SIGKILL)
    with pytest.raises(RenderError, match=r"the renderer ended by itself with status -9 \(it said nothing\)"):
        sim.render_ahead([PlannedPose(turntable_deg=angle) for angle in range(90)], lambda *_: None)
    assert "status -9" in sim.side_channel.status()["render"]["failed"]
    with turntable_of(sim) as table:
        table.prepare()
        table.go(80)


def test_a_renderer_that_cannot_load_is_told(tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    best_variant()  # what is broken from now on is not probed any more
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "mitsuba.py").write_text("raise ImportError('libfoo.so: cannot open shared object file')")
    monkeypatch.syspath_prepend(tmp_path / "broken")
    with simulated_rig(CONFIG, tmp_path / "sim", root) as sim, pytest.raises(RenderError, match="cannot open shared"):
        sim.render_ahead([PlannedPose(turntable_deg=7)], lambda *_: None)


def test_a_renderer_that_aborts_is_told_with_its_last_words(
    tmp_path: Path, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    best_variant()
    (tmp_path / "broken").mkdir()
    abort = "import os\nos.write(2, b'LLVM ERROR: Cannot select')\nos.abort()"
    (tmp_path / "broken" / "mitsuba.py").write_text(abort)
    monkeypatch.syspath_prepend(tmp_path / "broken")
    with (
        simulated_rig(CONFIG, tmp_path / "sim", root) as sim,
        pytest.raises(RenderError, match=r"status -6 \(LLVM ERROR: Cannot select\)"),
    ):
        sim.render_ahead([PlannedPose(turntable_deg=7)], lambda *_: None)


def test_all_processes_end_with_the_body(tmp_path: Path, root: Path) -> None:
    with simulated_rig(CONFIG, tmp_path / "sim", root):
        darkroom_of(tmp_path / "sim")
    assert processes_in(tmp_path / "sim") == []
    assert (tmp_path / "sim" / "server.log").read_text() == ""


def test_an_analytic_scene_has_nothing_to_render_ahead(sphere: RunningSim) -> None:
    told: list[tuple[int, int]] = []
    sphere.render_ahead([PlannedPose(turntable_deg=7)], lambda done, total: told.append((done, total)))
    assert told == [(0, 0)]
