import numpy as np
import pytest

from litrig.base.errors import InputError
from viewer.develop import Development, Tone


def test_nothing_is_changed_unless_asked_for() -> None:
    picture = np.array([[[-0.5, 0.2, 7.0, 0.3]]], np.float32)
    assert Development().apply(picture) is picture


def test_stops_double_the_light_and_leave_the_coverage() -> None:
    picture = np.array([[[0.1, 0.2, 3.0, 0.3]]], np.float32)
    np.testing.assert_allclose(Development(2).apply(picture), [[[0.4, 0.8, 12.0, 0.3]]], rtol=1e-6)


def test_reinhard_divides_by_one_more_than_the_luminance() -> None:
    picture = np.array([[[2.0, 1.0, 0.5]]], np.float32)
    luminance = 0.2126 * 2 + 0.7152 + 0.0722 * 0.5
    np.testing.assert_allclose(Development(0, Tone.REINHARD).apply(picture), picture / (1 + luminance), rtol=1e-6)


def test_the_film_s_curve_worked_out_by_hand() -> None:
    """(x·(2.51x + 0.03)) / (x·(2.43x + 0.59) + 0.14) at 0.5: 0.6425 / 1.0425."""
    light = np.array([[[0.0, 0.5, 1e9]]], np.float32)
    np.testing.assert_allclose(Development(0, Tone.FILMIC).apply(light), [[[0, 0.6425 / 1.0425, 1]]], rtol=1e-5)


@pytest.mark.parametrize("tone", [Tone.REINHARD, Tone.FILMIC])
def test_curves_grow_with_the_light_and_end_at_white(tone: Tone) -> None:
    grey = np.repeat(np.concatenate([[-1, 0], np.geomspace(1e-3, 1e6, 400)])[:, None], 3, axis=1)
    shown = Development(0, tone).apply(grey)[:, 0]
    assert np.all(np.diff(shown) >= 0)
    assert (shown[0], shown[1]) == (0, 0)
    assert 0.99 < shown[-1] <= 1


@pytest.mark.parametrize("stops", [float("nan"), float("inf"), 31.0, -31.0])
def test_an_exposure_that_is_none_is_refused(stops: float) -> None:
    with pytest.raises(InputError, match=r"stops are outside ±30"):
        Development(stops)
