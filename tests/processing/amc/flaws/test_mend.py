"""Cuts in the sample from pictures to table: marked by hand, or found."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.capture_folder.capture import Capture
from litrig.base.capture_folder.reader import read_capture
from litrig.base.errors import InputError
from processing.amc.build import AmcResult, build
from processing.amc.model import Invariance
from processing.amc.settings import Settings
from processing.outline.circle import Circle
from tests.processing.amc.brushed_sphere import Scene, true_table

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

CIRCLE, SHAPE, SLICES, SIZE = (79.3, 74.8, 66.4), (150, 158), 32, 48
ANGLES_DEG = np.arange(SLICES) * 360 / SLICES
SETTINGS = Settings(size=SIZE, circle=Circle(*CIRCLE), defects="ignore")


def three_cuts(angle_deg: float) -> Mask:
    """Three darts from the rim towards the middle, 8 % of the disc together, with the sample turned by an angle."""
    y, x = (np.indices(SHAPE) + 0.5) - np.array([CIRCLE[1], CIRCLE[0]])[:, None, None]
    radius, azimuth = np.hypot(x, y) / CIRCLE[2], np.degrees(np.arctan2(-y, x)) - angle_deg
    marked = np.zeros(SHAPE, bool)
    for middle in (20.0, 130.0, 260.0):
        off = (azimuth - middle + 180) % 360 - 180
        marked |= (np.abs(off) < 4.9) & (radius > 0.12)
    return np.asarray(marked & (radius < 1))


@dataclass
class CutScene(Scene):
    """The sphere with its cuts, which show what is beneath: something black."""

    cut: bool = True

    def picture(self, angle_deg: float) -> F64:
        light = super().picture(angle_deg)
        return np.where(three_cuts(angle_deg)[..., None], 0.01, light) if self.cut else light


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return shoot(tmp_path_factory.mktemp("whole"), cut=False)


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return shoot(tmp_path_factory.mktemp("cut"), cut=True)


def shoot(folder: Path, cut: bool) -> Capture:
    scene = CutScene("2", CIRCLE, SHAPE, noise=0.004, samples=2, cut=cut)
    return read_capture(scene.shoot(folder, ANGLES_DEG))


def psnr_db(result: AmcResult) -> float:
    table = result.amc.slices
    even = np.arange(len(table)) * 360 / (len(table) * result.amc.repeats)
    truth, radius = true_table("2", SIZE, even)
    inner = radius < 0.9
    return float(-10 * np.log10(np.mean((table - truth)[:, inner] ** 2)))


def test_the_cuts_cover_a_twelfth_of_the_sphere() -> None:
    y, x = (np.indices(SHAPE) + 0.5) - np.array([CIRCLE[1], CIRCLE[0]])[:, None, None]
    disc = np.hypot(x, y) < CIRCLE[2]
    assert 0.07 < three_cuts(0.0)[disc].mean() < 0.09


@pytest.mark.parametrize("invariance", [1, 2])
def test_three_marked_cuts_cost_less_than_a_decibel(whole: Capture, cut: Capture, invariance: Invariance) -> None:
    settings = replace(SETTINGS, invariance=invariance)
    left, spoilt = build(whole, settings), build(cut, settings)
    mended = build(cut, settings, mask=three_cuts(0.0))
    assert psnr_db(mended) > psnr_db(left) - 1
    assert psnr_db(spoilt) < psnr_db(left) - 6, "cuts that did no harm would prove nothing"
    assert 0.08 < mended.flaws.filled < 0.16


@pytest.mark.parametrize("invariance", [1, 2])
def test_three_cuts_that_nobody_marked_cost_less_than_a_decibel(
    whole: Capture, cut: Capture, invariance: Invariance
) -> None:
    settings = replace(SETTINGS, invariance=invariance)
    found = build(cut, replace(settings, defects="find"))
    assert psnr_db(found) > psnr_db(build(whole, settings)) - 1
    by_hand = build(cut, settings, mask=three_cuts(0.0)).flaws
    assert np.mean(found.flaws.turning[by_hand.turning]) > 0.9
    assert found.flaws.filled < 1.2 * by_hand.filled


def test_a_mask_belongs_to_the_picture_that_was_shot_first(cut: Capture) -> None:
    """Shot in another order, the first picture shows the cuts elsewhere."""
    later = replace(cut, frames=cut.frames[9:] + cut.frames[:9])
    settings = replace(SETTINGS, invariance=1)
    right = build(later, settings, mask=three_cuts(float(ANGLES_DEG[9])))
    wrong = build(later, settings, mask=three_cuts(0.0))
    assert psnr_db(right) > psnr_db(wrong) + 6


def test_a_whole_sphere_is_left_alone(whole: Capture) -> None:
    result = build(whole, replace(SETTINGS, defects="find"))
    assert result.flaws.filled == 0
    assert np.array_equal(result.amc.slices, build(whole, SETTINGS).amc.slices)


def test_a_mask_is_painted_over_the_picture_as_the_camera_took_it(whole: Capture) -> None:
    """Taking out the lens's distortion moves the sphere's middle by (-3.4, -3.3) pixels here, and the mask with it."""
    straight = CameraModel(
        width=SHAPE[1], height=SHAPE[0], focal_x_px=600, focal_y_px=600, centre_x_px=0, centre_y_px=0
    )
    bent = straight.model_copy(update={"distortion": (1.5, 0.0, 0.0, 0.0, 0.0)})
    spot = np.zeros(SHAPE, bool)
    spot[62:72, 82:92] = True
    places = []
    for camera, circle in ((straight, Circle(*CIRCLE)), (bent, Circle(75.9, 71.5, 58.5))):
        result = build(whole, replace(SETTINGS, circle=circle, camera=camera), mask=spot)
        places.append(np.argwhere(result.flaws.turning).mean(axis=0))
    assert places[1] == pytest.approx(places[0], abs=0.7)


def test_a_mask_of_another_size_is_refused(cut: Capture) -> None:
    with pytest.raises(InputError, match=r"mask has 100 × 90 pixels, the pictures have 158 × 150.*frame_0000\.png"):
        build(cut, SETTINGS, mask=np.zeros((90, 100), bool))


def test_a_mask_that_leaves_nothing_is_refused(cut: Capture) -> None:
    with pytest.raises(InputError, match=r"marks cover 100% of the sphere.*NO material"):
        build(cut, SETTINGS, mask=np.ones(SHAPE, bool))
