import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition.plans import AmcPlan, Plan, PtmPlan
from acquisition.tour import short_tour, shortest_tour, tour_cost
from litrig.base.directions import direction_from_angles
from litrig.base.errors import InputError
from rig.arm.travel import travel_times_s
from rig.config import ArmConfig

plans = st.builds(AmcPlan, slices=st.integers(8, 600)) | st.builds(PtmPlan, lights=st.integers(6, 60))


@given(plans)
def test_a_plan_is_as_long_as_it_says_and_the_same_each_time(plan: Plan) -> None:
    assert len(plan) == len(list(plan))
    assert list(plan) == list(plan)
    assert [step.step for step in plan] == list(range(len(plan)))


@given(st.integers(8, 600))
def test_slices_divide_one_turn_without_adding_up_errors(slices: int) -> None:
    angles = [step.angle_deg for step in AmcPlan(slices)]
    assert angles == [360 * s / slices for s in range(slices)]


def test_lights_are_spread_evenly() -> None:
    aims = [step.aim for step in PtmPlan(200) if step.aim is not None]
    directions = np.array([direction_from_angles(aim.azimuth_deg, aim.elevation_deg) for aim in aims])
    assert all(15 <= aim.elevation_deg <= 80 for aim in aims)
    nearest = np.sort(np.arccos(np.clip(directions @ directions.T, -1, 1)), axis=1)[:, 1]
    assert nearest.min() > 0.6 * np.median(nearest)
    np.testing.assert_allclose(directions.mean(0)[:2], 0, atol=0.02)


def test_file_names_tell_the_pose() -> None:
    assert [step.stem for step in AmcPlan(8)][1] == "000001_tt045.00"
    assert next(iter(PtmPlan(6))).stem.startswith("000000_az000.00_el")


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: AmcPlan(7), id="too few slices"),
        pytest.param(lambda: PtmPlan(5), id="too few lights for six coefficients"),
        pytest.param(lambda: PtmPlan(50, 40, 30), id="elevations swapped"),
        pytest.param(lambda: PtmPlan(50, float("nan"), 30), id="not a number"),
    ],
)
def test_plans_that_make_nothing_are_refused(make: object) -> None:
    assert callable(make)
    with pytest.raises(InputError):
        make()


@given(st.lists(st.tuples(st.floats(0, 360), st.floats(0, 90)), min_size=1, max_size=25))
def test_a_tour_visits_each_pose_once(joints: list[tuple[float, float]]) -> None:
    assert sorted(short_tour(joints)) == list(range(len(joints)))


def test_a_tour_is_much_shorter_than_the_spiral() -> None:
    aims = [step.aim for step in PtmPlan(50) if step.aim is not None]
    toured = np.array([(aim.azimuth_deg, aim.elevation_deg) for aim in aims])
    spiral = toured[np.argsort(toured[:, 1])]
    way = [np.linalg.norm(np.diff(points, axis=0), axis=1).sum() for points in (toured, spiral)]
    assert way[0] < 0.25 * way[1]


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


def test_a_plan_predicts_its_travel_and_the_spiral_takes_longer() -> None:
    arm = ArmConfig.model_validate({"port": "x"})
    toured, spiral = (PtmPlan(80, arm=arm, order=order).travel_s() for order in ("tour", "spiral"))
    assert toured is not None
    assert spiral is not None
    assert 80 * 0.2 < toured < 0.4 * spiral
    assert PtmPlan(80).travel_s() is None
    assert sorted(step.aim.azimuth_deg for step in PtmPlan(80, arm=arm) if step.aim) == sorted(
        step.aim.azimuth_deg for step in PtmPlan(80) if step.aim
    )


def test_a_tour_goes_around_a_zone() -> None:
    zone = {"name": "camera post", "azimuth_deg": [80, 100], "elevation_deg": [10, 60]}
    free = ArmConfig.model_validate({"port": "x"})
    blocked = ArmConfig.model_validate({"port": "x", "zones": [zone]})
    pair = [(70.0, 30.0), (110.0, 30.0)]
    assert travel_times_s(blocked, pair)[0, 1] > travel_times_s(free, pair)[0, 1] + 0.3
