import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.grbl.homing import homed_position, plan_homing, switch_positions
from firmware_sim.grbl.settings import HOMING_DIRECTIONS, light_arm_settings
from firmware_sim.motion import Track

SETTINGS = light_arm_settings((360, 90, 10))


@given(st.floats(-360, -0.01), st.floats(-90, -0.01), st.floats(-10, -0.01))
def test_homing_ends_a_pull_off_from_the_switches_wherever_it_began(x: float, y: float, z: float) -> None:
    homing = plan_homing(0.0, (x, y, z), SETTINGS, (0.0, 0.0, 0.0), "none")
    assert homing.alarm is None
    assert homing.pieces[-1].position == pytest.approx((-1, -1, -1))


def test_homing_begins_with_z_and_then_takes_both_arm_axes_together() -> None:
    start = (-300.0, -60.0, -5.0)
    homing = plan_homing(0.0, start, SETTINGS, (0.0, 0.0, 0.0), "none")
    track = Track(start, 0.0)
    track.follow(homing.pieces)
    assert track.position(0.1)[:2] == start[:2]
    later = track.position(1.2)
    assert later[2] == -1
    assert later[0] - start[0] == pytest.approx(later[1] - start[1])


def test_the_switches_are_approached_slowly_the_second_time() -> None:
    homing = plan_homing(0.0, (-5.0, -5.0, -5.0), SETTINGS, (0.0, 0.0, 0.0), "none")
    touching = [
        abs(before.velocity_at(after.start_s)[0])
        for before, after in itertools.pairwise(homing.pieces)
        if after.position[0] == pytest.approx(0, abs=1e-9) and before.position[0] < -1e-6
    ]
    assert touching == pytest.approx([50, 5])


def test_switches_may_stand_at_the_other_end() -> None:
    settings = dict(SETTINGS) | {HOMING_DIRECTIONS: 1}
    assert switch_positions(settings) == (-360, 0, 0)
    assert homed_position(settings, (0, 0, 0), [(2,), (0, 1)]) == (-359, -1, -1)
    assert homed_position(settings, (-7, -8, -9), [(2,)]) == (-7, -8, -1), "axes that do not home keep their place"
    homing = plan_homing(0.0, (-100.0, -5.0, -5.0), settings, switch_positions(settings), "none")
    assert homing.pieces[-1].position == pytest.approx((-359, -1, -1))


def test_an_axis_that_finds_no_switch_runs_into_the_frame() -> None:
    homing = plan_homing(0.0, (-100.0, -5.0, -5.0), SETTINGS, (0.0, 0.0, 0.0), "dead")
    assert max(piece.position[2] for piece in homing.pieces) == 2
    assert homing.ends_s == pytest.approx(15 / 50 + 50 / 500)
