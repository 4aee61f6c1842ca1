import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.motion import MEMORY_S, Profile, Track, along, merge, rest, stopping, trapezoid

PLACES = st.floats(-1000, 1000)
PROFILES = st.builds(Profile, speed=st.floats(0.5, 400), acceleration=st.floats(1, 8000))


@given(PLACES, st.floats(-300, 300), PLACES, PROFILES)
def test_every_plan_ends_at_rest_on_its_goal(start: float, speed: float, goal: float, profile: Profile) -> None:
    pieces = trapezoid(0.0, start, speed, goal, profile)
    assert pieces[-1] == rest(pieces[-1].start_s, (goal,))
    assert pieces[0].start_s == 0


@given(PLACES, st.floats(-300, 300), PLACES, PROFILES)
def test_a_plan_has_no_jumps(start: float, speed: float, goal: float, profile: Profile) -> None:
    pieces = trapezoid(0.0, start, speed, goal, profile)
    assert pieces[0].position == (start,)
    for before, after in itertools.pairwise(pieces):
        assert before.position_at(after.start_s) == pytest.approx(after.position, abs=1e-6)
        assert before.velocity_at(after.start_s) == pytest.approx(after.velocity, abs=1e-4)


@given(PLACES, PLACES, PROFILES)
def test_a_plan_from_rest_keeps_the_limits(start: float, goal: float, profile: Profile) -> None:
    pieces = trapezoid(0.0, start, 0.0, goal, profile)
    assert all(abs(piece.velocity[0]) <= profile.speed * (1 + 1e-9) for piece in pieces)
    assert all(abs(piece.acceleration[0]) <= profile.acceleration for piece in pieces)


@given(st.floats(0.01, 1000), PROFILES)
def test_a_plan_is_half_way_after_half_the_time(way: float, profile: Profile) -> None:
    track = Track((0.0,), 0.0)
    track.follow(trapezoid(0.0, 0.0, 0.0, way, profile))
    assert track.position(track.ends_s / 2)[0] == pytest.approx(way / 2, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("way", "speed", "acceleration", "seconds"),
    [
        pytest.param(90.0, 90.0, 600.0, 1.15, id="trapezoid: a ramp of 0.15 s at either end of a cruise of 0.85 s"),
        pytest.param(6.0, 90.0, 600.0, 0.2, id="triangle: the top speed is never reached"),
        pytest.param(-90.0, 90.0, 600.0, 1.15, id="backwards takes as long"),
        pytest.param(0.0, 90.0, 600.0, 0.0, id="nowhere to go"),
    ],
)
def test_how_long_a_move_takes(way: float, speed: float, acceleration: float, seconds: float) -> None:
    pieces = trapezoid(0.0, 10.0, 0.0, 10.0 + way, Profile(speed, acceleration))
    assert pieces[-1].start_s == pytest.approx(seconds)


def test_a_goal_behind_a_moving_motor_makes_it_brake_and_come_back() -> None:
    pieces = trapezoid(0.0, 0.0, 50.0, -10.0, Profile(100.0, 100.0))
    furthest = max(piece.position[0] for piece in pieces)
    assert furthest == pytest.approx(50**2 / 200)
    assert pieces[-1].position == (-10.0,)


def test_braking_takes_the_way_that_physics_wants() -> None:
    pieces = stopping(2.0, 7.0, -30.0, 100.0)
    assert pieces[-1].start_s == pytest.approx(2.3)
    assert pieces[-1].position[0] == pytest.approx(7.0 - 4.5)


def test_a_track_answers_for_the_past_after_a_new_plan() -> None:
    track = Track((0.0,), 0.0)
    track.follow(trapezoid(0.0, 0.0, 0.0, 90.0, Profile(90.0, 600.0)))
    before = track.position(0.4)
    track.halt(0.5)
    assert track.position(0.4) == before
    assert track.position(9.0) == track.position(0.5)
    assert track.is_resting(0.5)


def test_a_track_forgets_what_is_long_over() -> None:
    track = Track((0.0,), 0.0)
    for second in range(1, 200):
        track.follow([rest(float(second), (float(second),))])
    assert len(track.pieces_from(-math.inf)) <= MEMORY_S + 2
    assert track.position(199 - MEMORY_S + 1)[0] == 199 - MEMORY_S + 1


def test_axes_that_were_planned_apart_run_together() -> None:
    quick = trapezoid(0.0, 0.0, 0.0, 10.0, Profile(100.0, 1000.0))
    slow = trapezoid(0.0, 5.0, 0.0, -5.0, Profile(2.0, 1000.0))
    track = Track((0.0, 5.0), 0.0)
    track.follow(merge([quick, slow]))
    for time_s in (0.01, 0.1, 0.15, 1.0, 3.0, 6.0):
        alone = [Track(axis[0].position, 0.0) for axis in (quick, slow)]
        for one, pieces in zip(alone, (quick, slow), strict=True):
            one.follow(pieces)
        expected = tuple(one.position(time_s)[0] for one in alone)
        assert track.position(time_s) == pytest.approx(expected)


def test_a_line_in_space_has_the_speed_of_its_plan() -> None:
    track = Track((1.0, 1.0), 0.0)
    track.follow(along(trapezoid(0.0, 0.0, 0.0, 50.0, Profile(10.0, 100.0)), (1.0, 1.0), (0.6, -0.8)))
    assert math.hypot(*track.velocity(2.0)) == pytest.approx(10.0)
    assert track.position(60.0) == pytest.approx((31.0, -39.0))
