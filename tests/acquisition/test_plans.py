import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from acquisition.plans import AmcPlan, Plan, PtmPlan
from acquisition.tour import short_tour
from litrig.base.directions import direction_from_angles
from litrig.base.errors import InputError

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
