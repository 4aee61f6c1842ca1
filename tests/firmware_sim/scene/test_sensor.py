import numpy as np
import pytest

from firmware_sim.scene.pose import F32
from firmware_sim.scene.sensor import AutoExposure, Exposure, Sensor


def flat(level: float) -> F32:
    return np.full((200, 200, 3), level, np.float32)


def linear(codes: np.ndarray) -> np.ndarray:
    encoded = codes / 255
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("level", [0.02, 0.1, 0.5, 0.9])
def test_codes_decode_to_the_light(level: float) -> None:
    picture = Sensor(1e9, 0, 1).expose(flat(level), Exposure(0.01))
    assert linear(picture).mean() == pytest.approx(level, rel=0.02)


def test_time_and_gain_scale_alike() -> None:
    sensor = Sensor(1e9, 0, 1)
    longer = sensor.expose(flat(0.1), Exposure(0.02))
    amplified = sensor.expose(flat(0.1), Exposure(0.01, gain=25))
    np.testing.assert_array_equal(longer, amplified)


def test_noise_grows_with_the_root_of_the_light() -> None:
    sensor = Sensor(4000, 0, 1)
    deviations = [linear(sensor.expose(flat(level), Exposure(0.01))).std() for level in (0.1, 0.4)]
    assert deviations[0] == pytest.approx((0.1 / 4000) ** 0.5, rel=0.1)
    assert deviations[1] / deviations[0] == pytest.approx(2, rel=0.1)


def test_a_short_exposure_with_gain_is_noisier_than_a_long_one() -> None:
    sensor = Sensor(4000, 5, 1)
    long = sensor.expose(flat(0.3), Exposure(0.01)).std()
    short = sensor.expose(flat(0.3), Exposure(0.0025, gain=50)).std()
    assert short > 1.5 * long


def test_a_full_well_is_white_and_no_more() -> None:
    assert Sensor(20_000, 6, 1).expose(flat(3), Exposure(0.01)).min() >= 254


def test_a_black_frame_still_has_read_noise() -> None:
    picture = Sensor(20_000, 6, 1).expose(flat(0), Exposure(0.01))
    assert 0 < picture.mean() < 3
    assert len(np.unique(picture)) > 1


def test_no_two_pictures_are_alike() -> None:
    sensor = Sensor(20_000, 6, 1)
    first, second = (sensor.expose(flat(0.2), Exposure(0.01)) for _ in range(2))
    assert (first != second).mean() > 0.2


def test_a_seed_repeats_the_noise() -> None:
    first, second = (Sensor(20_000, 6, 7).expose(flat(0.2), Exposure(0.01)) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_automatic_exposure_arrives() -> None:
    automatic = AutoExposure()
    for _ in range(20):
        automatic.observe(flat(0.4), 1 / 30)
    assert automatic.time_s == pytest.approx(0.01 * automatic.TARGET / 0.4, rel=0.01)


def test_automatic_exposure_keeps_the_frame_rate_in_the_dark() -> None:
    automatic = AutoExposure()
    for _ in range(20):
        automatic.observe(flat(1e-5), 1 / 30)
    assert automatic.time_s == 1 / 30
