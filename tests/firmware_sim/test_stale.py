import itertools

from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.stale import INTERVAL_S, StaleFrames


@given(st.floats(1e-4, 10), st.floats(0, 1e6), st.integers(2, 60))
def test_times_rise_between_the_last_picture_and_the_rest(room_s: float, last_s: float, count: int) -> None:
    stale = StaleFrames()
    times = [last_s, *(stale.stamp_s("pose", last_s, lambda: last_s + room_s) for _ in range(count))]
    assert all(before < after for before, after in itertools.pairwise(times))
    assert times[-1] < last_s + room_s


def test_without_a_picture_before_it_the_first_is_before_the_rest_too() -> None:
    assert StaleFrames().stamp_s("pose", None, lambda: 50.0) < 50


def test_another_pose_has_another_rest() -> None:
    stale = StaleFrames()
    assert stale.stamp_s("here", 10.0, lambda: 11.0) < 11
    assert stale.stamp_s("here", 10.0, lambda: 99.0) < 11
    assert 19 < stale.stamp_s("there", 19.0, lambda: 20.0) < 20


def test_they_come_slowly() -> None:
    stale = StaleFrames()
    assert stale.is_due(5.0)
    assert not stale.is_due(5.0 + 0.9 * INTERVAL_S)
    assert stale.is_due(5.0 + INTERVAL_S)
