"""Lamps stand where the arm's pose says, and light is as strong as the sensor expects."""

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_sim.mitsuba import lighting
from firmware_sim.mitsuba.config import MitsubaScene, Sample
from firmware_sim.mitsuba.renderer import BACKDROP, MitsubaRenderer
from firmware_sim.scene.pose import Pose
from firmware_sim.scene.sensor import Exposure, Sensor

SIZE = (96, 128)
STILL = Pose(0.0, 0.0, 90.0, 0.0)


def brightest_normal(picture: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the normal of an orthographic ball at the highlight's centroid."""
    grey = picture.mean(axis=-1, dtype=np.float64)
    weight = np.where(grey > 0.2 * grey.max(), grey, 0)
    rows, columns = np.mgrid[0 : SIZE[0], 0 : SIZE[1]] + 0.5
    x = ((weight * columns).sum() / weight.sum() - 324.3 / 5) / 36
    y = (238.6 / 5 - (weight * rows).sum() / weight.sum()) / 36
    return np.array([x, y, np.sqrt(1 - x * x - y * y)])


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg"),
    [
        pytest.param(0, 45, id="from the right"),
        pytest.param(90, 45, id="from above"),
        pytest.param(215, 30, id="low, from the lower left"),
        pytest.param(300, 75, id="steep"),
        pytest.param(0, 90, id="from the camera"),
    ],
)
def test_the_highlight_on_a_chrome_ball_stands_at_the_half_vector(
    variant: str, azimuth_deg: float, elevation_deg: float
) -> None:
    ball = MitsubaScene(sample="chrome-ball", lights="lamp", projection="orthographic", samples=64)
    picture = MitsubaRenderer(ball, variant).render(Pose(0, azimuth_deg, elevation_deg, 1), SIZE)
    half = lighting.light_direction(azimuth_deg, elevation_deg) + np.array([0, 0, 1])
    half /= np.linalg.norm(half)
    off_deg = np.degrees(np.arccos(min(1.0, float(brightest_normal(picture) @ half))))
    assert off_deg < 1.0


def test_the_environment_shows_a_light_where_it_was_painted(variant: str) -> None:
    ball = MitsubaScene(sample="chrome-ball", projection="orthographic", samples=64)
    picture = MitsubaRenderer(ball, variant).render(STILL, SIZE)
    for middle, colour in ((lighting.KEY[0], "warm"), (lighting.FILL[0], "cool")):
        half = np.array(middle) / np.linalg.norm(middle) + np.array([0, 0, 1])
        x, y, _ = half / np.linalg.norm(half)
        red, _, blue = picture[int(238.6 / 5 - 36 * y), int(324.3 / 5 + 36 * x)]
        assert max(red, blue) > 5 * np.median(picture)
        assert (red > blue) == (colour == "warm")


def test_a_card_that_faces_the_lamp_is_flat_and_as_bright_as_its_albedo(variant: str) -> None:
    card = MitsubaScene(sample="white-card", lights="lamp", projection="orthographic", samples=32)
    picture = MitsubaRenderer(card, variant).render(Pose(0, 0, 90, 1), SIZE)
    assert picture.mean() == pytest.approx(0.9, rel=0.01)
    assert picture.std() < 0.02


def test_half_the_power_is_half_the_light_and_none_is_the_dark_room(variant: str) -> None:
    card = MitsubaRenderer(MitsubaScene(sample="white-card", lights="lamp", samples=32), variant)
    half, none = (float(card.render(Pose(0, 0, 90, lamp), SIZE).mean()) for lamp in (0.5, 0.0))
    assert half == pytest.approx(0.45, rel=0.01)
    assert 0 < none < 0.002


def test_a_near_lamp_falls_off_over_the_card(variant: str) -> None:
    card = MitsubaScene(sample="white-card", lights="near-lamp", lamp_distance_radii=4, projection="orthographic")
    picture = MitsubaRenderer(card, variant).render(Pose(0, 0, 90, 1), SIZE)
    middle = picture[44:52, 61:69].mean()
    # 40 px are 40/36 radii to the right: cos³ of the angle at which the lamp sees that place.
    aside = picture[44:52, 101:109].mean()
    assert middle == pytest.approx(0.9, rel=0.02)
    assert aside / middle == pytest.approx((1 + (40 / 36 / 4) ** 2) ** -1.5, rel=0.03)


@pytest.mark.parametrize("sample", ["brushed-metal", "fabric", "relief"])
def test_ten_milliseconds_expose_well(variant: str, sample: Sample) -> None:
    light = MitsubaRenderer(MitsubaScene(sample=sample, samples=32), variant).render(STILL, SIZE)
    codes = Sensor(20_000, 6, 1).expose(light, Exposure(0.01))
    assert 0.15 < codes.mean() / 255 < 0.5
    assert np.mean(codes.max(axis=-1) == 255) < 0.01


def test_behind_the_sample_hangs_black_cloth(variant: str) -> None:
    picture = MitsubaRenderer(MitsubaScene(samples=8), variant).render(STILL, SIZE)
    np.testing.assert_allclose(picture[:5, :5], np.broadcast_to(BACKDROP, (5, 5, 3)), atol=1e-6)
