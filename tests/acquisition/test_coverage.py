from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.coverage import coverage, light_coverage, turn_coverage
from acquisition.coverage_plot import plot_coverage
from acquisition.plans import Aim, Plan, amc_plan, ptm_plan
from acquisition.plans.light_path import LightPath, evenly, on_rings
from acquisition.plans.poses import ProductPoses, PtmPoses
from acquisition.plans.turn import Turn
from litrig.base.directions import angle_between_deg, direction_from_angles
from litrig.base.errors import InputError
from litrig.base.pictures import read_codes


def directions(aims: list[Aim]) -> list[np.ndarray]:
    return [direction_from_angles(aim.azimuth_deg, aim.elevation_deg) for aim in aims]


def test_the_largest_gap_of_a_ring_is_its_middle() -> None:
    covered = light_coverage(on_rings([(40, 12)]))
    assert covered.gap_deg == pytest.approx(50, abs=0.01)
    assert covered.gap_elevation_deg == pytest.approx(90, abs=0.01)
    assert (covered.min_elevation_deg, covered.max_elevation_deg, covered.lights) == (40, 40, 12)
    ring = directions(on_rings([(40, 12)]))
    assert covered.spacing_deg == pytest.approx(angle_between_deg(ring[0], ring[1]))


def test_lights_that_are_taken_away_leave_a_gap_where_they_were() -> None:
    hole = direction_from_angles(100, 40)
    left = [aim for aim in evenly(80) if angle_between_deg(directions([aim])[0], hole) > 20]
    covered = light_coverage(left)
    middle = direction_from_angles(covered.gap_azimuth_deg, covered.gap_elevation_deg)
    assert angle_between_deg(middle, hole) < 5
    assert 20 < covered.gap_deg < 30


@settings(max_examples=25)
@given(st.integers(1, 60))
def test_no_light_lies_within_the_gap(lights: int) -> None:
    aims = evenly(lights)
    covered = light_coverage(aims)
    middle = direction_from_angles(covered.gap_azimuth_deg, covered.gap_elevation_deg)
    nearest_deg = min(angle_between_deg(middle, direction) for direction in directions(aims))
    assert nearest_deg == pytest.approx(covered.gap_deg, abs=1e-6)


def test_the_same_light_twice_is_one() -> None:
    assert light_coverage([Aim(10, 20), Aim(10, 20), Aim(50, 20)]).lights == 2


@pytest.mark.parametrize(
    ("turn", "step_deg", "gap_deg"),
    [
        (Turn(90), 4, 4),
        (Turn(90, start_deg=-17, repeats=3), 4, 4),
        (Turn(10, range_deg=90), 10, 270),
        (Turn(1), 360, 360),
    ],
)
def test_slices_are_as_far_apart_as_they_are(turn: Turn, step_deg: float, gap_deg: float) -> None:
    covered = turn_coverage(turn)
    assert covered.slices == turn.slices
    assert (covered.step_deg, covered.gap_deg) == pytest.approx((step_deg, gap_deg))


def test_a_plan_covers_what_it_moves() -> None:
    amc, ptm = coverage(amc_plan(8)), coverage(ptm_plan(8))
    product = coverage(Plan(ProductPoses(Turn(8), LightPath(tuple(evenly(8))))))
    assert (amc.lights, ptm.turn) == (None, None)
    assert product.turn == amc.turn
    assert set(product.as_json()) == {"lights", "turn"}


@pytest.mark.parametrize(
    "plan",
    [amc_plan(8), ptm_plan(30), Plan(ProductPoses(Turn(5, range_deg=50), LightPath((Aim(0, 50), Aim(20, -5)))))],
    ids=lambda plan: plan.kind,
)
def test_coverage_is_drawn(tmp_path: Path, plan: Plan) -> None:
    plot_coverage(tmp_path / "plot.png", plan, coverage(plan))
    codes = read_codes(tmp_path / "plot.png")
    assert codes.shape == (900, 900, 3)
    amber = (np.abs(codes.astype(int) - (0xD9, 0xA7, 0x5A)).max(axis=-1) < 30).sum()
    assert amber > 100


def test_a_light_is_drawn_where_the_camera_would_see_it(tmp_path: Path) -> None:
    amber = []
    for left_deg in (0.0, 180.0):
        aims = tuple(Aim(left_deg + 10 * i - 30, 30.0) for i in range(6))
        one = Plan(PtmPoses(LightPath(aims)))
        plot_coverage(tmp_path / "plot.png", one, coverage(one))
        codes = read_codes(tmp_path / "plot.png").astype(int)
        _, columns = np.nonzero(np.abs(codes - (0xD9, 0xA7, 0x5A)).max(axis=-1) < 10)
        amber.append(columns.mean())
    assert amber[0] > 600 > 300 > amber[1]


def test_a_picture_in_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        plot_coverage(tmp_path / "absent" / "plot.png", amc_plan(8), coverage(amc_plan(8)))
