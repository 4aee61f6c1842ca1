"""Lights added by hand, as the maps have them."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from processing.matcap.lights.bake import baked
from processing.matcap.lights.footprints import footprint
from processing.matcap.lights.model import Disc, Edge, Hung, Light, Line, Picture, Spot
from processing.matcap.model import Component
from processing.matcap.recipe.material import with_filter_size
from processing.paraboloid.blur import blurred
from processing.paraboloid.maps import texel_directions

WHITE = (1.0, 1.0, 1.0)
AT = (0.36, 0.48, 0.8)
LIGHTS: dict[str, Light] = {
    "spot": Spot(colour=WHITE, direction=AT, size_deg=10),
    "disc": Disc(colour=WHITE, direction=AT, size_deg=15),
    "line": Line(colour=WHITE, start=AT, end=(-0.6, 0.48, 0.64), size_deg=6),
    "edge": Edge(colour=WHITE, pole=(0.6, 0.0, 0.8)),
}


def dark(size: int = 64, filter_size: float = 0.01) -> Component:
    black = np.zeros((size, size, 3), np.float32)
    return Component(black, black, WHITE, 0.9, filter_size)


def within(size: int) -> NDArray[np.bool_]:
    return np.stack(
        [side[..., 0] ** 2 + side[..., 1] ** 2 < (1 + abs(side[..., 2])) ** 2 for side in texel_directions(size)]
    )


@pytest.mark.parametrize("name", LIGHTS)
def test_a_material_blurs_a_light_as_the_maps_would_be_blurred(name: str) -> None:
    """The closed form on the plane, against a blur on the sphere of the light as a sharper material has it."""
    less = baked(dataclasses.replace(dark(96, 0.004), lights=(LIGHTS[name],)))
    more = baked(dataclasses.replace(dark(96, 0.034), lights=(LIGHTS[name],)))
    wanted = np.stack(blurred(less.front, less.back, 0.03))
    found = np.stack([more.front, more.back])
    assert wanted.max() > 0.25
    assert np.abs(found - wanted)[within(96)].max() < 0.025


@pytest.mark.parametrize("name", LIGHTS)
def test_an_unblurred_light_is_as_it_was_painted(name: str) -> None:
    directions = np.array([AT, (-0.6, 0.48, 0.64), (0.0, 0.0, -1.0), (0.6, 0.0, 0.8)])
    wanted = {
        "spot": [1, 0, 0, np.exp(-0.5 * (np.degrees(np.arccos(0.6 * 0.36 + 0.64)) / 10) ** 2)],
        "disc": [1, 0, 0, 0],
        "line": [0.5, 0.5, 0, 0],
        "edge": [1, 1, 0, 1],
    }
    np.testing.assert_allclose(footprint(LIGHTS[name], directions, 0.0), wanted[name], atol=1e-3)


def test_an_infinitely_wide_blur_takes_no_light_from_a_disc_but_spreads_it() -> None:
    """On a fine net of directions: the same sum, less at the middle."""
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(200_000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    sums = [footprint(LIGHTS["disc"], directions, variance).mean() for variance in (0.0, 0.02)]
    assert sums[1] == pytest.approx(sums[0], rel=0.05)


def test_lights_are_sharper_on_a_shinier_material_without_being_touched() -> None:
    painted = dataclasses.replace(dark(32, 0.05), lights=(LIGHTS["spot"],))
    shinier = with_filter_size(painted, 0.005)
    assert shinier.lights == painted.lights
    assert baked(shinier).front.max() > 1.5 * baked(painted).front.max()
    assert shinier.slope > painted.slope


def test_a_light_that_takes_away_ends_at_black() -> None:
    grey = np.full((32, 32, 3), 0.3, np.float32)
    shade = Spot(colour=(-1.0, -0.1, 0.0), direction=AT, size_deg=20)
    found = baked(dataclasses.replace(dark(32), front=grey, back=grey, lights=(shade,)))
    assert found.front[..., 0].min() == 0
    assert 0.2 < found.front[..., 1].min() < 0.3
    assert np.all(found.front[..., 2] == np.float32(0.3))


def flag() -> NDArray[np.float32]:
    """Red on the left, green on the right, its upper half brighter; the last row is not there."""
    texels = np.zeros((10, 20, 4), np.float32)
    texels[:, :10, 0], texels[:, 10:, 1], texels[..., 3] = 1, 1, 1
    texels[:5, :, :3] *= 2
    texels[9, :, 3] = 0
    return texels


def hung(turn_deg: float = 0.0, filter_size: float = 0.0) -> NDArray[np.float32]:
    picture = Picture(colour=(1.0, 0.5, 1.0), direction=(0.0, 0.0, 1.0), size_deg=60, turn_deg=turn_deg)
    component = dataclasses.replace(dark(64, filter_size), pictures=(Hung(picture, flag()),))
    return baked(component).front


def test_a_picture_hangs_as_it_is_seen_on_the_ball() -> None:
    front = hung()
    assert front[30, 28].tolist() == [2, 0, 0]  # above and left of the middle
    assert front[33, 35].tolist() == [0, 0.5, 0]  # below and right
    lit = np.nonzero(front.sum(axis=-1))
    # 30 degrees from the middle is at tan 15°, of 32 texels.
    assert abs(lit[1].max() - (31.5 + 32 * np.tan(np.radians(15)))) < 1.1
    assert lit[0].max() < lit[1].max() - 3
    turned = hung(90)
    assert turned[35, 30, 0] > 1 and turned[28, 30, 1] > 0.4


def test_a_material_blurs_pictures_too_and_keeps_their_light() -> None:
    u = (2 * np.arange(64) + 1) / 64 - 1
    area = 1 / (1 + u[:, None] ** 2 + u**2) ** 2
    sharp, soft = hung(), hung(filter_size=0.03)
    assert soft.max() < 0.9 * sharp.max()
    np.testing.assert_allclose((soft * area[..., None]).sum((0, 1)), (sharp * area[..., None]).sum((0, 1)), rtol=0.03)
