import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.dynamixel.registers import (
    GOAL_POSITION,
    TORQUE_ENABLE,
    acceleration_units,
    hardware_errors,
    profile_time_s,
    velocity_units,
)


@given(st.integers(-(2**31), 2**31 - 1))
def test_positions_keep_their_sign_over_the_wire(ticks: int) -> None:
    raw = GOAL_POSITION.encode(ticks)
    assert 0 <= raw < 2**32
    assert GOAL_POSITION.decode(raw) == ticks


def test_minus_five_hundred_as_the_wire_has_it() -> None:
    assert GOAL_POSITION.decode(4294966796) == -500


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="torque enable"):
        TORQUE_ENABLE.encode(256)


def test_units_follow_the_manual() -> None:
    assert velocity_units(0.229 * 6 * 100) == 100
    assert velocity_units(0.01) == 1
    assert acceleration_units(214.577 * 0.1 * 40) == 40


@pytest.mark.parametrize(
    ("way_deg", "time_s"),
    [
        pytest.param(0, 0, id="no way"),
        pytest.param(-90, 2.0, id="a long way: 1 s at full speed and half a second each to get there and back"),
        pytest.param(15, 2 * (15 / 120) ** 0.5, id="a short way never reaches full speed"),
    ],
)
def test_the_time_of_a_trapezoid(way_deg: float, time_s: float) -> None:
    assert profile_time_s(way_deg, speed_deg_s=60, acceleration_deg_s2=120) == pytest.approx(time_s)


def test_hardware_errors_are_words() -> None:
    assert hardware_errors(0b100100) == "overheating, overload"
