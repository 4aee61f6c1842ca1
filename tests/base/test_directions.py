import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from litrig.base.directions import angle_between_deg, angles_from_direction, direction_from_angles


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "direction"),
    [
        pytest.param(0, 0, (1, 0, 0), id="right"),
        pytest.param(90, 0, (0, 1, 0), id="up"),
        pytest.param(0, 90, (0, 0, 1), id="to the camera"),
        pytest.param(180, 60, (-0.5, 0, np.sqrt(3) / 2), id="left and high"),
    ],
)
def test_angles_follow_the_view_frame(azimuth_deg: float, elevation_deg: float, direction: tuple[float, ...]) -> None:
    np.testing.assert_allclose(direction_from_angles(azimuth_deg, elevation_deg), direction, atol=1e-15)


@given(st.floats(-720, 720), st.floats(-89.9, 89.9))
def test_angles_come_back(azimuth_deg: float, elevation_deg: float) -> None:
    direction = direction_from_angles(azimuth_deg, elevation_deg)
    back_azimuth_deg, back_elevation_deg = angles_from_direction(3 * direction)
    assert 0 <= back_azimuth_deg < 360
    back = direction_from_angles(back_azimuth_deg, back_elevation_deg)
    assert angle_between_deg(direction, back) < 1e-6


def test_nothing_has_no_direction() -> None:
    with pytest.raises(ValueError, match="length zero"):
        angles_from_direction(np.zeros(3))
