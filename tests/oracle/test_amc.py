"""An AMC of parallels predicts other brushings of the same material, as physics renders them.

One cell of each table; `make oracle` measures them all.
"""

import pytest

from firmware_sim.mitsuba.config import Brushing, Invariance
from tests.oracle.measure import fabric_verdict, predict_brushing
from tests.oracle.shoot import MATERIALS, Studio

GOAL_DB, WRONG_DB = 27, 18


@pytest.mark.parametrize(
    ("material", "brushing", "distance_radii"),
    [("rough aluminium", "circular", None), ("weave", "tilted-pole", 4.0)],
)
def test_a_table_predicts_another_brushing_and_needs_the_right_tangent(
    studio: Studio, material: str, brushing: Brushing, distance_radii: float | None
) -> None:
    prediction = predict_brushing(studio, MATERIALS[material], brushing, distance_radii)
    assert prediction.right_db >= GOAL_DB
    assert prediction.off_by_90_db < WRONG_DB


@pytest.mark.parametrize("invariance", [3, "isotropic"], ids=lambda invariance: f"R = {invariance}")
def test_the_invariance_of_a_woven_sphere_is_found(studio: Studio, invariance: Invariance) -> None:
    assert fabric_verdict(studio, invariance, distance_radii=8).invariance.found == invariance
