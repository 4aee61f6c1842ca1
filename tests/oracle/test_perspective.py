"""The rectified table of perspective pictures is the one that is nearest to the orthographic truth, for metal."""

import pytest

from litrig.base.table_normals import TableNormal
from tests.oracle.measure import perspective_error
from tests.oracle.shoot import METALS, NAIVE, OTHER_BRUSHINGS, Studio


@pytest.mark.parametrize("distance_radii", [4, 8, 20])
def test_rectified_is_nearer_than_the_crop_and_than_the_full_turn(studio: Studio, distance_radii: float) -> None:
    metal = METALS["rough aluminium"]

    def error(way: TableNormal | None) -> float:
        each = [perspective_error(studio, metal, distance_radii, way, brushing) for brushing in OTHER_BRUSHINGS]
        return sum(each) / len(each)

    assert error(TableNormal.RECTIFIED) < min(error(NAIVE), error(TableNormal.VIEW))
