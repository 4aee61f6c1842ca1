"""The lamp in a ball, picture by picture."""

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.directions import angle_between_deg
from processing.outline.circle import Circle
from processing.ptm.lights.highlight import Flag, Highlight, find_highlights
from processing.ptm.lights.mirror import Mirror
from tests.processing.ptm.lights.mirror_balls import Balls, lamps

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
LIGHTS = lamps(7)
BALL = Mirror(Circle(*Balls().balls[0]))


def shots(scene: Balls, lights: F64 = LIGHTS) -> F32:
    return np.stack([scene.picture(light, n)[..., 0] for n, light in enumerate(lights)]).astype(np.float32)


def errors_deg(found: list[Highlight | None], lights: F64 = LIGHTS) -> list[float]:
    return [
        angle_between_deg(BALL.directions(np.array([[spot.x_px, spot.y_px]]))[0], light)
        for spot, light in zip(found, lights, strict=True)
        if spot is not None
    ]


@pytest.mark.parametrize(
    ("scene", "white"),
    [
        pytest.param(Balls(), np.inf, id="with all its brightness"),
        pytest.param(Balls(), 1.0, id="far beyond white"),
        pytest.param(Balls(lamp=0.9, window=0.5), 1.0, id="below white, beside a bright window"),
        pytest.param(Balls(noise=0.01), 1.0, id="with noise"),
        pytest.param(Balls(background="black"), 1.0, id="in the dark"),
    ],
)
def test_a_lamp_is_seen_where_it_is(scene: Balls, white: float) -> None:
    found = find_highlights(np.minimum(shots(scene), np.float32(white)), BALL)
    errors = errors_deg(found)
    assert len(errors) == len(LIGHTS)
    # A sixth of a pixel is half a degree on a ball of this size.
    assert np.mean(errors) < 0.5
    assert not any(spot.flags for spot in found if spot)


def test_exposure_does_not_matter() -> None:
    pictures = shots(Balls())
    dark, bright = (find_highlights(pictures * np.float32(gain), BALL) for gain in (1e-3, 50.0))
    for low, high in zip(dark, bright, strict=True):
        assert low is not None
        assert high is not None
        assert (low.x_px, low.y_px) == pytest.approx((high.x_px, high.y_px), abs=1e-3)


def test_a_ball_in_shadow_shows_nothing_though_a_window_shines_in_it() -> None:
    found = find_highlights(shots(Balls(dark=(3,), window=0.9)), BALL)
    assert [spot is None for spot in found] == [False, False, False, True, False, False, False]


def test_lamps_of_unequal_power_are_all_seen() -> None:
    pictures = shots(Balls(window=0.0)) * np.array([1, 0.2, 1, 3, 1, 0.3, 1], np.float32)[:, None, None]
    assert len(errors_deg(find_highlights(pictures, BALL))) == len(LIGHTS)


def test_a_second_lamp_is_noticed() -> None:
    found = find_highlights(shots(Balls(second={2: (-0.5, -0.4, 0.7)})), BALL)
    assert [spot.flags for spot in found if spot] == [(), (), (Flag.DOUBLE,), (), (), (), ()]


def test_a_long_reflection_as_bright_as_the_lamp_does_not_win() -> None:
    pictures = shots(Balls())
    # The lit table, along the lower rim.
    rows, columns = np.indices(pictures.shape[1:]) + 0.5
    x, y = (columns - BALL.circle.x_px) / BALL.circle.radius_px, (rows - BALL.circle.y_px) / BALL.circle.radius_px
    arc = (np.abs(np.hypot(x, y) - 0.86) < 0.02) & (y > 0.72)
    pictures[1, arc] = 12.0
    assert max(errors_deg(find_highlights(pictures, BALL))) < 1


def test_what_the_ball_mirrors_from_behind_is_doubtful() -> None:
    lights = np.concatenate([lamps(6), [[0.8, 0.1, -0.59]]])
    found = find_highlights(shots(Balls(), lights), BALL)
    assert found[-1] is not None
    assert Flag.RIM in found[-1].flags
    assert errors_deg(found, lights / np.linalg.norm(lights, axis=1, keepdims=True))[-1] < 3


def test_a_large_lamp_is_called_broad_and_found_in_its_middle() -> None:
    found = find_highlights(shots(Balls(lamp_deg=14.0)), BALL)
    assert all(spot is not None and Flag.BROAD in spot.flags for spot in found)
    assert np.mean(errors_deg(found)) < 0.5


def test_one_picture_is_enough_where_no_window_shines() -> None:
    found = find_highlights(shots(Balls(window=0.0), LIGHTS[2:3]), BALL)
    assert errors_deg(found, LIGHTS[2:3])[0] < 1
