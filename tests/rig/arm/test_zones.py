import itertools
import math
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig.arm.geometry import Joints
from rig.arm.travel import Travel, travel_times_s, way_time_s
from rig.arm.zones import Box, Reach
from rig.config import ArmConfig
from rig.errors import OutOfRangeError

CAMERA_POST = {"name": "camera post", "azimuth_deg": (80, 100), "elevation_deg": (20, 60)}
WALL = {"name": "wall", "azimuth_deg": (170, 190), "elevation_deg": (0, 90)}
SHADOW = {"name": "in the picture", "azimuth_deg": (260, 280), "elevation_deg": (70, 90), "may_pass": True}
joints = st.builds(Joints, st.floats(0, 360), st.floats(5, 88))


def arm(*zones: Mapping[str, object], **keys: object) -> ArmConfig:
    return ArmConfig.model_validate({"port": "x", "zones": zones, **keys})


def cost(start: Joints, end: Joints) -> float:
    return math.dist(start, end)


@pytest.mark.parametrize(
    ("start", "end", "crossed"),
    [
        pytest.param((70, 40), (110, 40), True, id="right through"),
        pytest.param((70, 10), (110, 70), True, id="a corner is cut"),
        pytest.param((70, 60), (110, 60), False, id="along the edge"),
        pytest.param((80, 10), (80, 70), False, id="along the other edge"),
        pytest.param((70, 40), (79, 40), False, id="ends before it"),
        pytest.param((90, 40), (90, 40), True, id="stands in it"),
        pytest.param((90, 10), (90, 15), False, id="straight up, below it"),
        pytest.param((90, 10), (90, 30), True, id="straight up, into it"),
    ],
)
def test_a_straight_way_crosses_a_box_or_not(
    start: tuple[float, float], end: tuple[float, float], crossed: bool
) -> None:
    assert Box(Joints(80, 20), Joints(100, 60)).is_crossed(Joints(*start), Joints(*end)) is crossed


@given(joints, joints)
def test_a_box_is_crossed_where_points_on_the_way_lie_within(start: Joints, end: Joints) -> None:
    box = Box(Joints(80, 20), Joints(100, 60))
    points = np.linspace(start, end, 500)
    inside = any(box.holds(Joints(*map(float, point))) for point in points)
    assert inside <= box.is_crossed(start, end)


@given(joints, joints)
def test_a_route_ends_at_its_goal_and_touches_no_zone(start: Joints, goal: Joints) -> None:
    reach = Reach(arm(CAMERA_POST, SHADOW))
    post = Box(Joints(80, 20), Joints(100, 60))
    if post.holds(start) or post.holds(goal):
        return
    way = reach.route(start, goal, cost)
    assert way is not None
    assert way[-1] == goal
    assert not any(post.is_crossed(a, b) for a, b in itertools.pairwise([start, *way]))


def test_a_route_around_is_the_shorter_of_two() -> None:
    way = Reach(arm(CAMERA_POST)).route(Joints(70, 55), Joints(110, 55), cost)
    assert way == [Joints(79.5, 60.5), Joints(100.5, 60.5), Joints(110, 55)]


def test_a_wall_has_no_way_around_unless_the_cables_have_one() -> None:
    assert Reach(arm(WALL)).route(Joints(160, 30), Joints(200, 30), cost) is None
    wide = Reach(arm(WALL, max_azimuth_deg=720, azimuth_origin_deg=-720))
    poses = wide.poses(Joints(200, 30))
    assert poses == [Joints(200, 30), Joints(560, 30)]
    assert [wide.route(Joints(500, 30), pose, cost) is not None for pose in poses] == [True, False]


def test_a_zone_forbids_to_stop_in_every_turn_of_the_azimuth() -> None:
    reach = Reach(arm(CAMERA_POST, max_azimuth_deg=720, azimuth_origin_deg=-720))
    assert reach.poses(Joints(90, 40)) == []
    assert reach.zone_at(Joints(450, 40)) == "camera post"


def test_a_zone_of_the_picture_may_be_passed() -> None:
    reach = Reach(arm(SHADOW))
    assert reach.poses(Joints(270, 80)) == []
    assert reach.route(Joints(250, 80), Joints(290, 80), cost) == [Joints(290, 80)]


def test_an_arm_that_stands_in_a_zone_comes_out_by_the_nearest_side() -> None:
    way = Reach(arm(CAMERA_POST)).route(Joints(98, 40), Joints(70, 40), cost)
    assert way is not None
    assert way[0] == Joints(100.5, 40)
    assert way[-1] == Joints(70, 40)


def test_times_of_a_way_add_up_from_rest_to_rest() -> None:
    travel = Travel(100, 500)
    assert travel.time_s(Joints(0, 10), Joints(5, 10)) == pytest.approx(2 * math.sqrt(5 / 500))
    assert travel.time_s(Joints(0, 10), Joints(100, 10)) == pytest.approx(1 + 0.2)
    way = [Joints(100, 10), Joints(100, 15)]
    assert way_time_s(Joints(0, 10), way, travel) == pytest.approx(1.2 + 0.2)


def test_predicted_times_are_those_of_the_routes() -> None:
    config = arm(CAMERA_POST)
    directions = [(20.0, 30.0), (70.0, 30.0), (110.0, 30.0), (95.0, 70.0), (300.0, 50.0)]
    times = travel_times_s(config, directions)
    reach, travel = Reach(config), Travel.of(config)
    for i, j in itertools.permutations(range(len(directions)), 2):
        way = reach.route(Joints(*directions[i]), Joints(*directions[j]), travel.time_s)
        assert way is not None
        assert times[i, j] == pytest.approx(way_time_s(Joints(*directions[i]), way, travel))


def test_a_plan_that_the_arm_cannot_travel_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="azimuth 90°, elevation 40° is outside its reach; mend the plan"):
        travel_times_s(arm(CAMERA_POST), [(10.0, 40.0), (90.0, 40.0)])
    with pytest.raises(OutOfRangeError, match="no way leads around the zones"):
        travel_times_s(arm(WALL), [(160.0, 40.0), (200.0, 40.0)])
