"""Light directions read off a rendered chrome ball are where the lamps stood. `make oracle` measures more cameras."""

from pathlib import Path

import pytest

from tests.oracle.measure import light_errors
from tests.oracle.shoot import Studio

GOAL_MEAN_DEG, GOAL_MOST_DEG = 0.5, 1.0
SIDE_PX, SAMPLES = 112, 16


@pytest.fixture(scope="module")
def sharp_studio(variant: str, tmp_path_factory: pytest.TempPathFactory) -> Studio:
    """Many pixels and few samples, for a pixel is degrees on a small ball and a lamp without extent has no noise."""
    folder: Path = tmp_path_factory.mktemp("chrome")
    return Studio(variant, SIDE_PX, SAMPLES, folder)


@pytest.mark.parametrize("distance_radii", [None, 8.0], ids=["orthographic", "from eight radii"])
def test_directions_from_a_ball_that_is_found_by_itself(sharp_studio: Studio, distance_radii: float | None) -> None:
    errors = light_errors(sharp_studio, distance_radii)
    assert errors.mean_deg < GOAL_MEAN_DEG
    assert errors.most_deg < GOAL_MOST_DEG
    assert errors.outline < 0.01


def test_perspective_matters(sharp_studio: Studio) -> None:
    assert light_errors(sharp_studio, 8.0, ignore_distance=True).mean_deg > 2
