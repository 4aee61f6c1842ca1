"""Closure frames held against the first of a turn."""

import numpy as np
import pytest

from acquisition.plans import Aim, Step
from acquisition.revisit import Revisits
from litrig.base.capture_folder.capture import Role
from litrig.base.radiometry import U8
from tests.faults.fake_sessions import painted

CLOSURE = Step(9, Role.CLOSURE, angle_deg=0.0)


def noisy(angle_deg: float, seed: int, shade: float = 1.0) -> U8:
    codes = np.kron(painted(angle_deg, shade), np.ones((5, 5, 1)))
    noise = np.random.default_rng(seed).normal(0, 3, codes.shape)
    return np.asarray(np.clip(codes + noise, 0, 255), np.uint8)


def turning(step_deg: float, tolerance_deg: float = 0.3) -> Revisits:
    revisits = Revisits(tolerance_deg)
    for step in range(6):
        revisits.watch(Step(step, angle_deg=step_deg * step), step_deg * step, noisy(step_deg * step, step))
    return revisits


@pytest.mark.parametrize("step_deg", [1.0, 5.0, 30.0])
@pytest.mark.parametrize("slip_deg", [-20.0, -1.5, 1.5, 5.0, 40.0])
def test_a_slip_is_seen_and_measured(step_deg: float, slip_deg: float) -> None:
    said = turning(step_deg).judge(CLOSURE, 0.0, noisy(slip_deg, 99))
    assert said
    if abs(slip_deg) < 5:
        assert float(said.split()[3].rstrip("°")) == pytest.approx(slip_deg, rel=0.5)


@pytest.mark.parametrize("step_deg", [1.0, 5.0, 30.0])
@pytest.mark.parametrize("turned_deg", [-0.3, 0.0, 0.3])
def test_where_the_table_says_that_it_stands_is_no_slip(step_deg: float, turned_deg: float) -> None:
    assert turning(step_deg).judge(CLOSURE, turned_deg, noisy(turned_deg, 99)) == ""


def test_a_whole_turn_is_no_slip() -> None:
    assert turning(5.0).judge(Step(9, Role.CLOSURE, angle_deg=360.0), 360.0, noisy(0.0, 99)) == ""


def test_another_light_is_a_difference() -> None:
    assert "differs from the first" in turning(5.0).judge(CLOSURE, 0.0, noisy(0.0, 99, shade=0.5))


def test_without_a_frame_beside_it_only_a_large_change_counts() -> None:
    revisits = Revisits(0.3)
    revisits.watch(Step(0, angle_deg=0.0), 0.0, noisy(0.0, 0))
    assert revisits.judge(CLOSURE, 0.0, noisy(1.0, 1)) == ""
    assert "differs from the first" in revisits.judge(CLOSURE, 0.0, noisy(60.0, 1))


def test_what_was_lit_otherwise_is_not_compared() -> None:
    lit = Step(9, Role.CLOSURE, angle_deg=0.0, aim=Aim(10.0, 40.0))
    assert turning(5.0).judge(lit, 0.0, noisy(90.0, 99)) == ""
