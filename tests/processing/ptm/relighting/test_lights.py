import numpy as np
import pytest

from processing.ptm.relighting.lights import Lights, lamps
from tests.processing.ptm.relief import dome


def test_lamps_are_unit_and_white_unless_coloured() -> None:
    lights = lamps([(0.6, 0), (0, -1)])
    assert lights.directions == pytest.approx(np.array([[0.6, 0, 0.8], [0, -1, 0]]))
    assert lights.colours == pytest.approx(1)
    assert lamps([(0, 0)], [(1, 0.5, 0)]).colours == pytest.approx(np.array([[1, 0.5, 0]]))


def test_exposure_is_in_stops() -> None:
    assert lamps([(0, 0)]).exposed(-2).colours == pytest.approx(0.25)


@pytest.mark.parametrize("rings", [1, 4])
def test_cells_have_equal_solid_angle(rings: int) -> None:
    even = dome(20_000, 0)
    gathered = Lights(even, np.ones((len(even), 3))).gathered(rings)
    assert len(gathered.colours) == 4 * rings**2
    assert gathered.colours == pytest.approx(len(even) / (4 * rings**2), rel=0.05)
    assert np.linalg.norm(gathered.directions, axis=1) == pytest.approx(1)


def test_gathering_keeps_the_light_and_puts_it_where_most_of_it_is() -> None:
    lights = lamps([(0.5, 0.2), (0.52, 0.2)], [(9, 6, 3), (1, 0, 0)])
    gathered = lights.gathered(2)
    assert gathered.colours == pytest.approx(np.array([[10, 6, 3]]))
    assert gathered.directions[0, 0] == pytest.approx(0.501, abs=2e-3)


def test_one_light_stays_where_it_is() -> None:
    for light in (lamps([(0.3, -0.7)]), lamps([(0, 0)]), lamps([(-1, 0)])):
        assert light.gathered(5).directions == pytest.approx(light.directions)


def test_dark_cells_are_left_out() -> None:
    assert len(lamps([(0.5, 0.5), (-0.5, 0.5)], [(0, 0, 0), (0, 0, 1)]).gathered(3).colours) == 1


def test_a_softened_light_is_a_disc_of_its_colour_in_all() -> None:
    lights = lamps([(0.3, -0.2)], [(2, 1, 0.5)])
    soft = lights.softened(12, 40)
    off_deg = np.degrees(np.arccos(np.clip(soft.directions @ lights.directions[0], -1, 1)))
    assert (len(off_deg), soft.colours.sum(axis=0).tolist()) == (40, pytest.approx([2, 1, 0.5]))
    assert off_deg.max() == pytest.approx(12, abs=0.2)
    assert np.mean(off_deg < 6) == pytest.approx(0.25, abs=0.03), "spread evenly over the disc"
    assert np.linalg.norm(soft.directions, axis=1) == pytest.approx(1)


def test_what_of_a_soft_light_is_below_the_horizon_gives_nothing() -> None:
    low = lamps([(1, 0)]).softened(10, 200)
    assert np.all(low.directions[:, 2] >= 0)
    assert low.colours.sum(axis=0) == pytest.approx([0.5] * 3, abs=0.03)


def test_a_light_of_no_size_stays_as_it_is() -> None:
    lights = lamps([(0.3, 0.2)])
    assert lights.softened(0, 16) is lights
