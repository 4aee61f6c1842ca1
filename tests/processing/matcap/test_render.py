"""What a decomposed MatCap shows, against the formulas of its light."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from processing.matcap.disc import disc_normals
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.render import component_light, disc_picture, unwarped, warped
from processing.matcap.silhouette import Silhouette
from processing.paraboloid.maps import texel_directions
from tests.processing.matcap.maps import analytic, sharp

NORMALS, VALID = disc_normals(48)


def under_turned_light(turn: Rotation, size: int = 256) -> Component:
    """The high frequencies of the same lamps after they went round, as maps made anew."""
    front, back = (sharp(turn.apply(side.reshape(-1, 3), inverse=True)) for side in texel_directions(size))
    first, second = (side.reshape(size, size, 3).astype(np.float32) for side in (front, back))
    return dataclasses.replace(analytic(size).high, front=first, back=second)


@pytest.mark.parametrize("turn_deg", [(0, 30, 0), (-60, 0, 0), (0, 0, 90), (40, -50, 20)], ids=str)
def test_turned_light_is_the_light_of_lamps_that_went_round(turn_deg: tuple[float, float, float]) -> None:
    turn = Rotation.from_rotvec(turn_deg, degrees=True)
    still = analytic(256).high
    found = component_light(dataclasses.replace(still, light_turn_deg=turn_deg), NORMALS[VALID])
    wanted = component_light(under_turned_light(turn), NORMALS[VALID])
    assert wanted.std() > 0.03
    assert np.abs(found - wanted).max() < 0.03
    assert np.abs(component_light(still, NORMALS[VALID]) - wanted).max() > 0.2


def test_turned_normals_turn_the_picture() -> None:
    """As the paper's text has it: what was seen at n is seen at R n, whatever the slope is."""
    turn = (0.0, 25.0, 0.0)
    still = analytic(128).low
    front = NORMALS[VALID]
    from_where = Rotation.from_rotvec(turn, degrees=True).apply(front, inverse=True)
    stays = from_where[:, 2] > 0.05
    found = component_light(dataclasses.replace(still, normal_turn_deg=turn), front)[stays]
    np.testing.assert_allclose(found, component_light(still, from_where[stays]), atol=1e-9)


def test_normals_that_show_a_direction_are_found_again() -> None:
    directions = warped(NORMALS[VALID], 0.7)
    np.testing.assert_allclose(unwarped(directions, 0.7), NORMALS[VALID], atol=1e-12)


def test_the_silhouette_is_a_cubic_that_leaves_flat_and_arrives_with_its_slope() -> None:
    silhouette = Silhouette(40.0, 0.6, 1.5)
    step = 1e-5
    edge = np.pi / 2
    assert silhouette.added(np.radians([0.0, 20.0, 40.0])).tolist() == [0, 0, 0]
    assert silhouette.added(np.array([edge]))[0] == pytest.approx(0.6)
    inner, outer = silhouette.added(np.array([edge - step, edge]))
    assert (outer - inner) / step == pytest.approx(1.5, rel=1e-3)
    first, second = silhouette.added(np.radians(40.0) + np.array([0.0, step]))
    assert (second - first) / step == pytest.approx(0, abs=1e-3)
    theta = np.linspace(np.radians(40), edge, 40)
    t = (theta - theta[0]) / (edge - theta[0])
    hermite = 0.6 * (3 * t**2 - 2 * t**3) + 1.5 * (edge - theta[0]) * (t**3 - t**2)
    np.testing.assert_allclose(silhouette.added(theta), hermite, atol=1e-12)


def test_a_silhouette_multiplies_the_light_by_the_same_for_all_channels_and_stays_when_the_light_turns() -> None:
    still = dataclasses.replace(analytic(64).low, light_turn_deg=(0.0, 40.0, 0.0))
    with_edge = dataclasses.replace(still, silhouette=Silhouette(30.0, 0.8, 0.0))
    added = component_light(with_edge, NORMALS[VALID]) - component_light(still, NORMALS[VALID])
    light = component_light(still, NORMALS[VALID]) / np.asarray(still.base_colour)
    theta = np.arccos(NORMALS[VALID][:, 2])
    np.testing.assert_allclose(added, light * Silhouette(30.0, 0.8, 0.0).added(theta)[:, None], atol=1e-9)
    assert added.max() > 0.1


def test_a_disc_picture_has_the_source_s_size_and_nothing_outside() -> None:
    matcap: DecomposedMatcap = dataclasses.replace(analytic(64), picture_size=40)
    picture = disc_picture(matcap)
    assert picture.shape == (40, 40, 3)
    assert not picture[0, 0].any() and picture[20, 20].all()
    assert disc_picture(matcap, 24).shape == (24, 24, 3)
