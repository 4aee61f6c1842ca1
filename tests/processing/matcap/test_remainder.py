"""What maps lack of their disc, after edits."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from processing.matcap.disc import disc_normals
from processing.matcap.model import Component, DecomposedMatcap, Turn
from processing.matcap.recipe.lighting import paint, rotate
from processing.matcap.recipe.material import recolour, roughen, scale
from processing.matcap.recipe.mixing import take
from processing.matcap.recipe.operations import Colour, Gain, One, Paint, Rotate, Roughness, Take, Which
from processing.matcap.remainder import with_remainder
from processing.matcap.render import component_light, disc_picture, half_pictures, remainder_share
from tests.processing.matcap.discs import hard_edged
from tests.processing.matcap.maps import analytic

SIDE = 40
NORMALS, INSIDE = disc_normals(SIDE)
DISC = hard_edged(SIDE)
PLAIN = analytic(48, slopes=(0.3, 1.0))
COLOUR = np.array(PLAIN.high.base_colour)
WHOLE = dataclasses.replace(PLAIN, high=with_remainder(PLAIN.high, DISC), picture_size=SIDE)


def high_of(matcap: DecomposedMatcap) -> np.ndarray:
    return half_pictures(matcap)[1]


def under(component: Component, turn: Turn) -> np.ndarray:
    return component_light(dataclasses.replace(component, light_turn_deg=turn), NORMALS[INSIDE])


def test_maps_of_something_else_altogether_show_the_disc() -> None:
    np.testing.assert_allclose(high_of(WHOLE)[INSIDE], (DISC * COLOUR)[INSIDE], atol=1e-5)


def test_maps_that_lack_nothing_have_none() -> None:
    shown = np.zeros((SIDE, SIDE, 3))
    shown[INSIDE] = component_light(dataclasses.replace(PLAIN.high, base_colour=(1, 1, 1)), NORMALS[INSIDE])
    assert with_remainder(PLAIN.high, shown).remainder is None


def test_it_takes_on_the_colour_and_the_gain_of_its_component() -> None:
    found = recolour(scale(WHOLE, Gain(low=1, high=2)), Colour(component=Which.HIGH, base_colour=(0.2, 0.5, 3)))
    np.testing.assert_allclose(high_of(found)[INSIDE], (DISC * (0.2, 0.5, 3))[INSIDE], atol=1e-4)
    np.testing.assert_allclose(half_pictures(found)[0], half_pictures(WHOLE)[0])


@pytest.mark.parametrize("turn", [(0, 0, 90), (0, 0, -90)])
def test_it_goes_round_the_view_axis_with_the_light(turn: Turn) -> None:
    found = high_of(rotate(WHOLE, Rotate(axis="z", degrees=turn[2])))
    wanted = np.rot90(DISC * COLOUR, int(turn[2] / 90))
    np.testing.assert_allclose(found[INSIDE], wanted[INSIDE], atol=1e-4)


def test_it_fades_as_the_light_is_tipped_and_is_gone_after_a_degree() -> None:
    tips = [Rotation.from_rotvec((0, tip, 0), degrees=True) for tip in (0, 0.25, -0.75, 1, 180)]
    assert [remainder_share(tip) for tip in tips] == pytest.approx([1, 0.75, 0.25, 0, 0])
    assert remainder_share(Rotation.from_rotvec((0, 0, 170), degrees=True)) == pytest.approx(1)
    np.testing.assert_array_equal(under(WHOLE.high, (5, 20, 30)), under(PLAIN.high, (5, 20, 30)))
    assert np.abs(under(WHOLE.high, (0, 0.5, 0)) - under(PLAIN.high, (0, 0.5, 0))).max() > 0.1


def test_painted_light_comes_on_top() -> None:
    spot = Paint(at=(0.1, 0.2), size_deg=10, colour=(0.5, 0.5, 0.5))
    added = high_of(paint(WHOLE, spot)) - high_of(WHOLE)
    np.testing.assert_allclose(
        added,
        high_of(paint(dataclasses.replace(PLAIN, picture_size=SIDE), spot))
        - high_of(dataclasses.replace(PLAIN, picture_size=SIDE)),
        atol=1e-5,
    )
    assert added.max() > 0.1


def test_another_roughness_leaves_it_out_and_the_same_one_does_not() -> None:
    assert roughen(WHOLE, Roughness(component=Which.HIGH, filter_size=0.1)).high.remainder is None
    same = Roughness(component=Which.HIGH, degrees=np.degrees(np.sqrt(WHOLE.high.filter_size)))
    assert roughen(WHOLE, same).high is WHOLE.high


def test_it_goes_with_its_component_into_a_matcap_of_larger_maps() -> None:
    large = dataclasses.replace(analytic(96), picture_size=SIDE)
    found = take(large, Take(component=One.HIGH, from_file="x"), WHOLE)
    assert found.high.front.shape == (96, 96, 3)
    np.testing.assert_allclose(high_of(found)[INSIDE], high_of(WHOLE)[INSIDE], atol=2e-5)
    assert disc_picture(found).min() >= 0


def test_a_component_brighter_than_its_floats_lacks_what_is_finite() -> None:
    bright = dataclasses.replace(analytic(16).low, base_colour=(1e305, 1.0, 1.0))
    kept = with_remainder(bright, np.full((16, 16, 3), 0.5)).remainder
    assert kept is not None and np.all(np.isfinite(kept))
