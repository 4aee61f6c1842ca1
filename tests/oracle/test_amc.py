"""An AMC of parallels predicts other brushings of the same metal, as physics renders them."""

import pytest

from firmware_sim.mitsuba.config import Brushing, Invariance
from tests.oracle.measure import fabric_verdict, predict_brushing
from tests.oracle.shoot import FABRICS, METALS, OTHER_BRUSHINGS, Studio

GOAL_DB, WRONG_DB = 27, 18


@pytest.mark.parametrize("brushing", OTHER_BRUSHINGS)
@pytest.mark.parametrize("metal", METALS)
def test_a_table_predicts_another_brushing_and_needs_the_right_tangent(
    studio: Studio, metal: str, brushing: Brushing
) -> None:
    prediction = predict_brushing(studio, METALS[metal], brushing)
    assert prediction.right_db >= GOAL_DB
    assert prediction.off_by_90_db < WRONG_DB


@pytest.mark.parametrize("invariance", FABRICS, ids=lambda invariance: f"R = {invariance}")
def test_the_invariance_of_a_woven_sphere_is_found(studio: Studio, invariance: Invariance) -> None:
    assert fabric_verdict(studio, invariance, distance_radii=8).invariance.found == invariance
