from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from firmware_sim.config import CameraSim, SimConfig
from firmware_sim.darkroom import Darkroom, serve
from firmware_sim.errors import RenderError, SideChannelError
from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.render_queue import RenderQueue
from firmware_sim.render_requests import render_requests
from firmware_sim.scene.frame_cache import FrameCache
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.side_channel import Answer

SIZE = (240, 320)
CONFIG = SimConfig(camera=CameraSim(width=320, height=240), scene=MitsubaScene())
ANGLES = (0, 5.625, 7.0)
STOPS = [{"turntable_deg": angle} for angle in ANGLES]
AT_REST = [Pose(0, 0, 0, 1), Pose(5.625, 0, 0, 1), Pose(7.031, 0, 0, 1)]
"""7° lies between two ticks of the servo; it rests on the 80th."""


class Channel:
    """The server's handlers, without a socket."""

    def __init__(self, config: SimConfig = CONFIG) -> None:
        self.queue = RenderQueue(room=100)
        self._handlers = render_requests(self.queue, config, lambda: Pose(31.6, 0, 45, 0))

    def request(self, do: str, **parameters: object) -> Answer:
        return self._handlers[do](**parameters)


class FakeRenderer:
    def __init__(self, frame: Callable[[Size], F32] = lambda size: np.ones((*size, 3), np.float32)) -> None:
        self.rendered: list[Pose] = []
        self._frame = frame

    def render(self, pose: Pose, size: Size) -> F32:
        self.rendered.append(pose)
        return self._frame(size) * np.float32(pose.turntable_deg / 100)


def cache_in(folder: Path) -> FrameCache:
    return FrameCache(folder, "scene", "renderer")


def develop(channel: Channel, folder: Path) -> list[Pose]:
    """Render all that is asked for, with a renderer of its own as after a new start."""
    renderer = FakeRenderer()
    darkroom = Darkroom(channel, cache_in(folder), lambda: renderer)
    while darkroom.work():
        pass
    return renderer.rendered


def test_a_plan_is_rendered_for_the_places_where_the_devices_will_stand(tmp_path: Path) -> None:
    channel = Channel()
    assert channel.request("render.ahead", poses=STOPS)["total"] == 3
    assert develop(channel, tmp_path) == AT_REST
    assert channel.request("render.progress") == {"done": 3, "total": 3, "note": "", "failed": ""}
    frame = cache_in(tmp_path).load(AT_REST[2], SIZE)
    assert frame is not None
    np.testing.assert_allclose(frame, 0.07031, rtol=1e-3)


def test_what_is_in_the_cache_is_not_rendered_again(tmp_path: Path) -> None:
    for expected in (AT_REST, []):
        channel = Channel()
        channel.request("render.ahead", poses=STOPS)
        assert develop(channel, tmp_path) == expected
        assert channel.request("render.progress")["done"] == 3


def test_a_full_cache_needs_no_renderer_at_all(tmp_path: Path) -> None:
    channel = Channel()
    channel.request("render.ahead", poses=STOPS)
    develop(channel, tmp_path)
    channel.request("render.ahead", poses=STOPS)
    darkroom = Darkroom(channel, cache_in(tmp_path), lambda: pytest.fail("it was made"))
    assert [darkroom.work() for _ in range(4)] == [True, True, True, False]


def test_a_damaged_picture_is_rendered_again(tmp_path: Path) -> None:
    channel = Channel()
    channel.request("render.ahead", poses=STOPS)
    develop(channel, tmp_path)
    path = cache_in(tmp_path).path(AT_REST[1], SIZE)
    path.write_bytes(path.read_bytes()[:-40] + bytes(40))
    channel.request("render.ahead", poses=STOPS)
    assert develop(channel, tmp_path) == [AT_REST[1]]


def test_what_the_camera_waits_for_is_rendered_before_the_plan(tmp_path: Path) -> None:
    channel = Channel()
    channel.request("render.ahead", poses=STOPS)
    channel.request("render.urgent", pose=(200, 0, 0, 1), size=SIZE)
    assert develop(channel, tmp_path) == [Pose(200, 0, 0, 1), *AT_REST]


def test_a_plan_in_batches_is_one_plan(tmp_path: Path) -> None:
    channel = Channel()
    channel.request("render.ahead", poses=STOPS[:2])
    assert channel.request("render.ahead", poses=STOPS[2:], anew=False)["total"] == 3
    assert develop(channel, tmp_path) == AT_REST


@pytest.mark.parametrize(
    ("lights", "stops", "rendered"),
    [
        pytest.param(
            "studio",
            [{"turntable_deg": 9, "azimuth_deg": azimuth} for azimuth in (1, 2, 3)],
            [Pose(8.965, 0, 0, 1)],
            id="the arm is not seen under fixed lights",
        ),
        pytest.param(
            "lamp",
            [{"azimuth_deg": 30, "elevation_deg": 45.006, "lamp": lamp} for lamp in (1, 0)],
            [Pose(31.6, 30, 45.01, 1), Pose(31.6, 0, 0, 0)],
            id="the lamp is, and the table stays where it is",
        ),
    ],
)
def test_only_what_matters_makes_another_picture(
    tmp_path: Path, lights: str, stops: list[dict[str, float]], rendered: list[Pose]
) -> None:
    scene = MitsubaScene.model_validate({"lights": lights})
    channel = Channel(CONFIG.model_copy(update={"scene": scene}))
    channel.request("render.ahead", poses=stops)
    assert develop(channel, tmp_path) == rendered


def test_an_analytic_scene_has_nothing_to_render() -> None:
    channel = Channel(SimConfig())
    assert channel.request("render.ahead", poses=STOPS)["total"] == 0
    assert channel.queue.next() is None


def out_of_memory(size: Size) -> F32:
    raise MemoryError("no room for the kernel")


@pytest.mark.parametrize(
    ("frame", "reason"),
    [
        pytest.param(out_of_memory, "no room for the kernel", id="an error"),
        pytest.param(
            lambda size: np.full((*size, 3), np.nan, np.float32), "no picture of 320 × 240", id="not a number"
        ),
        pytest.param(lambda _: np.zeros((2, 2, 3), np.float32), "no picture of 320 × 240", id="another size"),
    ],
)
def test_a_renderer_that_fails_is_told(tmp_path: Path, frame: Callable[[Size], F32], reason: str) -> None:
    channel = Channel()
    channel.request("render.ahead", poses=STOPS)
    darkroom = Darkroom(channel, cache_in(tmp_path), lambda: FakeRenderer(frame))
    with pytest.raises((MemoryError, RenderError), match=reason):
        serve(darkroom, channel, wait=lambda _: None)
    assert reason in channel.request("render.progress")["failed"]
    assert list(tmp_path.iterdir()) == []


def test_the_end_of_the_simulator_is_no_failure_of_the_renderer(tmp_path: Path) -> None:
    class Gone(Channel):
        def request(self, do: str, **parameters: object) -> Answer:
            if do == "render.next":
                raise SideChannelError("gone")
            raise AssertionError(do)

    channel = Gone()
    with pytest.raises(SideChannelError, match="gone"):
        serve(Darkroom(channel, cache_in(tmp_path), FakeRenderer), channel, wait=lambda _: None)
