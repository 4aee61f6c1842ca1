import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.relighting.environment import environment_lights

HEIGHT = 90


def texel(row: int, column: int) -> NDArray[np.float64]:
    panorama = np.zeros((HEIGHT, 2 * HEIGHT, 3))
    panorama[row, column] = [3, 2, 1]
    return panorama


@pytest.mark.parametrize(
    ("row", "column", "direction"),
    [
        pytest.param(45, 90, [0, 0, 1], id="the centre is towards the camera"),
        pytest.param(0, 90, [0, 1, 0], id="the top row is up"),
        pytest.param(89, 90, [0, -1, 0], id="the bottom row is down"),
        pytest.param(45, 134, [-1, 0, 0], id="right of the centre is the left of the view"),
        pytest.param(45, 45, [1, 0, 0], id="left of the centre is the right of the view"),
        pytest.param(22, 67, [0.5, np.sqrt(0.5), 0.5], id="up and left"),
    ],
)
def test_where_a_texel_shines_from(row: int, column: int, direction: list[float]) -> None:
    lights = environment_lights(texel(row, column))
    assert lights.directions[0] == pytest.approx(direction, abs=0.04)
    assert np.linalg.norm(lights.directions[0]) == pytest.approx(1)
    assert lights.colours[0] / lights.colours[0, 2] == pytest.approx([3, 2, 1])


def test_turning_moves_light_from_behind_the_camera_to_the_right() -> None:
    turned = environment_lights(texel(45, 90), 60)
    assert turned.directions[0] == pytest.approx([np.sin(np.radians(60)), 0, 0.5], abs=0.04)


def test_a_texel_weighs_its_solid_angle() -> None:
    """Of the half-sphere, whose texels together weigh 1."""
    even = environment_lights(np.ones((HEIGHT, 2 * HEIGHT, 3)))
    assert even.colours.sum(axis=0) == pytest.approx(1)
    assert np.all(even.directions[:, 2] > 0)
    weight = np.sin(np.pi * 22.5 / HEIGHT) * (np.pi / HEIGHT) ** 2 / (2 * np.pi)
    assert environment_lights(texel(22, 67)).colours[0] == pytest.approx(weight * np.array([3, 2, 1]), rel=1e-3)


@pytest.mark.parametrize(
    ("panorama", "message"),
    [
        pytest.param(np.ones((8, 8, 3)), "sky.exr: 8 × 8 pixels are not twice as wide as high", id="a square"),
        pytest.param(texel(45, 10), "sky.exr: black all over its middle half", id="light from behind alone"),
    ],
)
def test_what_cannot_be_an_environment_is_refused(panorama: NDArray[np.float64], message: str) -> None:
    with pytest.raises(InputError, match=message):
        environment_lights(panorama, 0, "sky.exr")
