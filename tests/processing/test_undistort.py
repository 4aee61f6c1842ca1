import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.camera_model import CameraModel
from litrig.base.errors import InputError
from processing.undistort import undistortion

SHAPE = (120, 160)


def camera(*distortion: float) -> CameraModel:
    return CameraModel(
        width=SHAPE[1],
        height=SHAPE[0],
        focal_x_px=200,
        focal_y_px=210,
        centre_x_px=83.0,
        centre_y_px=57.5,
        distortion=(distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]),
    )


def smooth(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """A function of corner-based pixel coordinates, nearly straight between pixels."""
    return np.stack([x / 160, y / 120, 0.5 + 0.3 * np.sin(x / 40) * np.cos(y / 35)], axis=-1)


def test_a_straightened_pixel_shows_what_the_lens_put_elsewhere() -> None:
    """Brown and Conrady's formula by hand: where the ray of a straight pixel met the distorted picture."""
    model = camera(-0.25, 0.08, 0.003, -0.002, 0.01)
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    a, b = (x - 83.0) / 200, (y - 57.5) / 210
    r2 = a * a + b * b
    radial = 1 - 0.25 * r2 + 0.08 * r2**2 + 0.01 * r2**3
    seen_a = a * radial + 2 * 0.003 * a * b - 0.002 * (r2 + 2 * a * a)
    seen_b = b * radial + 0.003 * (r2 + 2 * b * b) - 2 * 0.002 * a * b
    straighten = undistortion(model)
    assert straighten is not None
    straight = straighten(smooth(x, y).astype(np.float32))
    expected = smooth(seen_a * 200 + 83.0, seen_b * 210 + 57.5)
    assert straight[3:-3, 3:-3] == pytest.approx(expected[3:-3, 3:-3], abs=2e-3)


def test_a_lens_without_distortion_needs_nothing() -> None:
    assert undistortion(camera(0, 0, 0, 0, 0)) is None
    assert undistortion(None) is None


def test_pictures_of_another_size_than_the_calibration_are_refused() -> None:
    straighten = undistortion(camera(-0.1, 0, 0, 0, 0))
    assert straighten is not None
    with pytest.raises(InputError, match="160 × 120 pixels, the pictures have 80 × 60"):
        straighten(np.zeros((60, 80, 3), np.float32))
