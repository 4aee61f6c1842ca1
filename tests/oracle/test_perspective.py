"""Which table of perspective pictures is nearest to the orthographic truth."""

from litrig.base.table_normals import TableNormal
from tests.oracle.measure import perspective_error, split_errors
from tests.oracle.shoot import BOTH, METALS, NAIVE, OTHER_BRUSHINGS, Studio


def test_rectified_is_nearer_than_the_crop_and_than_the_full_turn(studio: Studio) -> None:
    def error(way: TableNormal | None) -> float:
        metal = METALS["rough aluminium"]
        return sum(perspective_error(studio, metal, 4.0, way, brushing) for brushing in OTHER_BRUSHINGS)

    assert error(TableNormal.RECTIFIED) < min(error(NAIVE), error(TableNormal.VIEW))


def test_a_table_for_each_kind_of_light_is_no_worse_than_one_for_both(studio: Studio) -> None:
    errors = split_errors(studio, BOTH, 4.0, "circular")
    assert errors.split <= min(errors.rectified, errors.camera)
