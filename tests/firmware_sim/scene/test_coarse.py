import numpy as np

from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.scene.coarse import CoarseRenderer, Economy
from firmware_sim.scene.pose import F32, Pose, Size
from firmware_sim.scene.rendering import note_on


class Ramp:
    """Paints a ramp, and remembers what it was asked for."""

    def __init__(self, scene: MitsubaScene) -> None:
        self.samples = scene.samples
        self.sizes: list[Size] = []

    def render(self, pose: Pose, size: Size) -> F32:
        self.sizes.append(size)
        return np.broadcast_to(np.linspace(0, 1, size[1], dtype=np.float32)[None, :, None], (*size, 3)).copy()


def test_fewer_pixels_and_paths_are_rendered_and_a_whole_picture_comes_out() -> None:
    made: list[Ramp] = []

    def make(scene: MitsubaScene) -> Ramp:
        made.append(Ramp(scene))
        return made[-1]

    coarse = CoarseRenderer(MitsubaScene(samples=64), make, Economy(shrink=4, most_samples=16))
    picture = coarse.render(Pose(0.0, 0.0, 45.0, 0.0), (48, 64))
    assert made[0].samples == 16
    assert made[0].sizes == [(12, 16)]
    assert picture.shape == (48, 64, 3)
    assert np.all(np.diff(picture[24, :, 0]) >= 0)


def test_few_paths_stay_as_few() -> None:
    made: list[Ramp] = []

    def make(scene: MitsubaScene) -> Ramp:
        made.append(Ramp(scene))
        return made[-1]

    CoarseRenderer(MitsubaScene(samples=4), make)
    assert made[0].samples == 4


def test_a_slow_variant_is_said_so() -> None:
    assert "scalar_rgb, which is slow: one pixel for 4 × 4" in note_on("scalar_rgb")
    assert note_on("llvm_ad_rgb") == ""
