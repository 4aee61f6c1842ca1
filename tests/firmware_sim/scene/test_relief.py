import numpy as np
import pytest

from firmware_sim.config import ReliefScene
from firmware_sim.scene.pose import F32, Pose
from firmware_sim.scene.relief import PENUMBRA_PX, Relief, light_direction, lit, shade

SIZE = (240, 320)
GREY = np.full((101, 121, 3), 0.5, np.float32)
DIRECTIONS = [
    pytest.param(0, (0, 1), id="from the right"),
    pytest.param(90, (-1, 0), id="from above"),
    pytest.param(180, (0, -1), id="from the left"),
    pytest.param(270, (1, 0), id="from below"),
]
"""Azimuth, and the step in rows and columns of a picture that leads towards the lamp."""


def bump() -> F32:
    rows, columns = np.mgrid[0:101, 0:121].astype(np.float32)
    return np.asarray(6 * np.exp(-((rows - 50) ** 2 + (columns - 60) ** 2) / 50), np.float32)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "direction"),
    [
        pytest.param(0, 0, (1, 0, 0), id="x is right"),
        pytest.param(90, 0, (0, 1, 0), id="y is up"),
        pytest.param(123, 90, (0, 0, 1), id="z is to the camera"),
        pytest.param(180, 60, (-0.5, 0, 0.8660254), id="elevation counts from the picture's plane"),
    ],
)
def test_the_lamp_s_direction(azimuth_deg: float, elevation_deg: float, direction: tuple[float, ...]) -> None:
    assert light_direction(azimuth_deg, elevation_deg) == pytest.approx(direction, abs=1e-6)


@pytest.mark.parametrize(("azimuth_deg", "step"), DIRECTIONS)
def test_the_side_towards_the_lamp_is_bright(azimuth_deg: float, step: tuple[int, int]) -> None:
    picture = shade(bump(), GREY, azimuth_deg, 50).mean(2)
    towards = picture[50 + 5 * step[0], 60 + 5 * step[1]]
    away = picture[50 - 5 * step[0], 60 - 5 * step[1]]
    assert towards > 1.3 * picture[5, 5] > 1.3 * away


@pytest.mark.parametrize(("azimuth_deg", "step"), DIRECTIONS)
def test_shadows_fall_away_from_the_lamp(azimuth_deg: float, step: tuple[int, int]) -> None:
    seen = lit(bump(), azimuth_deg, 15)
    assert seen[50 - 15 * step[0], 60 - 15 * step[1]] < 0.05
    assert seen[50 + 15 * step[0], 60 + 15 * step[1]] > 0.95


@pytest.mark.parametrize("elevation_deg", [20.0, 30.0, 45.0])
def test_a_wall_s_shadow_is_as_long_as_the_lamp_stands_low(elevation_deg: float) -> None:
    heights = np.zeros((41, 121), np.float32)
    heights[:, 100:104] = 12
    shadow = 1 - lit(heights, 0, elevation_deg)[20, :100]
    assert shadow.sum() == pytest.approx((12 - PENUMBRA_PX / 2) / np.tan(np.radians(elevation_deg)) - 0.5, abs=0.5)


def test_nothing_beyond_the_picture_throws_shadows() -> None:
    slope = np.tile(np.linspace(0, 60, 121, dtype=np.float32), (101, 1))
    assert lit(slope, 0, 40).min() > 0.95
    assert lit(slope, 37, 89).min() > 0.95


def test_a_plane_is_lambertian_apart_from_its_gloss() -> None:
    flat = np.zeros((101, 121), np.float32)
    middle = [shade(flat, GREY, 30, elevation)[50, 60, 0] for elevation in (10, 20, 40)]
    ratios = [value / np.sin(np.radians(elevation)) for value, elevation in zip(middle, (10, 20, 40), strict=True)]
    assert ratios[0] == pytest.approx(0.5, rel=0.1)
    assert ratios[0] < ratios[1] < ratios[2]


def test_without_the_lamp_the_frame_is_nearly_black() -> None:
    scene = Relief(ReliefScene())
    dark, bright = (scene.light([Pose(0, 135, 45, lamp)], SIZE) for lamp in (0, 1))
    assert 0 < dark.max() < 1e-3
    assert bright.mean() > 0.05
    assert np.mean(bright.max(2) > 1) < 0.001


def test_light_is_proportional_to_the_lamp_s_power() -> None:
    scene = Relief(ReliefScene())
    dark, half, full = (scene.light([Pose(0, 135, 45, lamp)], SIZE) for lamp in (0, 0.5, 1))
    np.testing.assert_allclose(2 * (half - dark), full - dark, atol=1e-5)


def test_the_coin_turns_counter_clockwise_with_the_table() -> None:
    scene = Relief(ReliefScene())
    # With the lamp overhead, only the albedo is left to see, and a quarter turn keeps the pixels' grid.
    upright, turned = (scene.light([Pose(angle, 0, 90, 1)], SIZE) for angle in (0, 90))
    square = np.s_[10:230, 50:270]
    expected = np.rot90(upright[square])
    assert np.abs(turned[square] - expected).mean() < 0.1 * np.abs(upright[square] - expected).mean()


def test_a_coin_beside_the_table_lies_still() -> None:
    scene = Relief(ReliefScene(turns=False))
    first, second = (scene.light([Pose(angle, 20, 40, 1)], SIZE) for angle in (0, 50))
    np.testing.assert_array_equal(first, second)


def test_a_lamp_switched_during_the_exposure_gives_its_share() -> None:
    scene = Relief(ReliefScene())
    poses = [Pose(0, 20, 40, lamp) for lamp in (0, 0, 0, 1)]
    full = scene.light([poses[-1]], SIZE)
    np.testing.assert_allclose(scene.light(poses, SIZE), 0.25 * full, atol=1e-3)
