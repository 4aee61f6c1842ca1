import numpy as np

from processing.shape.albedo import illumination

USED = np.ones((2, 3), bool)


def test_shading_is_divided_by_albedo() -> None:
    albedo = np.random.default_rng(0).uniform(0.1, 1, (2, 3, 3)).astype(np.float32)
    light, told = illumination(albedo * np.float32(2.5), albedo, USED)
    np.testing.assert_allclose(light, 2.5, rtol=1e-6)
    assert told.all()


def test_a_channel_that_is_black_everywhere_keeps_no_pixel_back() -> None:
    albedo = np.broadcast_to(np.array([0.5, 0.25, 0], np.float32), (2, 3, 3))
    light, told = illumination(albedo * 2, albedo, USED)
    np.testing.assert_allclose(light, np.broadcast_to([2, 2, 0], (2, 3, 3)))
    assert told.all()


def test_black_pixels_tell_nothing() -> None:
    albedo = np.full((2, 3, 3), 0.5, np.float32)
    albedo[0, 1, 2] = 0
    light, told = illumination(albedo, albedo, USED)
    assert np.argwhere(~told).tolist() == [[0, 1]]
    assert np.isfinite(light).all()


def test_an_albedo_that_is_black_everywhere_is_no_division() -> None:
    light, told = illumination(np.zeros((2, 3, 3), np.float32), np.zeros((2, 3, 3), np.float32), USED)
    assert told.all()
    assert not light.any()
