import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from acquisition.tour import short_tour, shortest_tour, tour_cost
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig


@given(st.lists(st.tuples(st.floats(0, 360), st.floats(0, 90)), min_size=1, max_size=25))
def test_a_tour_visits_each_pose_once(joints: list[tuple[float, float]]) -> None:
    assert sorted(short_tour(joints)) == list(range(len(joints)))


def test_the_tour_of_a_few_poses_is_the_best_there_is() -> None:
    random = np.random.default_rng(3)
    for _ in range(20):
        points = random.uniform(0, 1, (7, 2))
        costs = np.linalg.norm(points[:, None] - points[None], axis=-1)
        best = min(tour_cost(costs, (0, *order)) for order in itertools.permutations(range(1, 7)))
        assert tour_cost(costs, shortest_tour(costs, 0)) <= 1.1 * best


def test_a_tour_by_travel_time_uses_the_turns_that_the_cables_allow() -> None:
    narrow, wide = (
        ArmConfig.model_validate({"port": "x", "max_azimuth_deg": top, "azimuth_origin_deg": -top})
        for top in (360.0, 720.0)
    )
    pair = [(350.0, 45.0), (10.0, 45.0)]
    assert travel_times_s(narrow, pair)[0, 1] > 3 > 0.5 > travel_times_s(wide, pair)[0, 1]


def test_a_tour_goes_around_a_zone() -> None:
    zone = {"name": "camera post", "azimuth_deg": [80, 100], "elevation_deg": [10, 60]}
    free = ArmConfig.model_validate({"port": "x"})
    blocked = ArmConfig.model_validate({"port": "x", "zones": [zone]})
    pair = [(70.0, 30.0), (110.0, 30.0)]
    assert travel_times_s(blocked, pair)[0, 1] > travel_times_s(free, pair)[0, 1] + 0.3
