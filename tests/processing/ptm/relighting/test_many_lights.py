import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.progress import Progress
from litrig.base.radiometry import decode_srgb, encode_srgb
from processing.ptm.basis import PTM, Basis
from processing.ptm.model import Colour, Ptm, Space
from processing.ptm.relighting.environment import environment_lights
from processing.ptm.relighting.highlight import Highlight, shade
from processing.ptm.relighting.lights import Lights, lamps
from processing.ptm.relighting.many_lights import light_weights, relight_by_many
from processing.ptm.relighting.relight import relight
from tests.processing.ptm.relief import dome
from tests.processing.ptm.relighting.materials import BASES, TINT, lambert, sphere_normals

NORMALS = sphere_normals(17)
TWO = lamps([(0.5, 0.1), (-0.3, 0.6)], [(1, 0.5, 0.2), (0.1, 0.4, 0.9)])


def as_light(values: NDArray[np.float32], space: Space) -> NDArray[np.float32]:
    return decode_srgb(values) if space == "srgb" else values


@pytest.mark.parametrize("basis", [PTM, Basis("ptm", 3), Basis("hsh", 9)], ids=str)
@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_pictures_under_several_lights_add_up_as_light(basis: Basis, colour: Colour, space: Space) -> None:
    sphere = lambert(NORMALS, basis, space, colour)
    gloss = Highlight(NORMALS.astype(np.float32), 0.3, 20)
    for highlight in (None, gloss):
        pictures = [as_light(shade(sphere, direction, highlight), space) for direction in TWO.directions]
        expected = pictures[0] * TWO.colours[0] + pictures[1] * TWO.colours[1]
        assert relight_by_many(sphere, TWO, highlight) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("basis", BASES, ids=str)
@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_an_even_environment_shows_the_mean(basis: Basis, space: Space) -> None:
    """Of a material that was captured down to the horizon: beyond its lights a fit swings, and cells are too coarse."""
    sphere = lambert(NORMALS, basis, space, lowest_deg=3)
    lights = environment_lights(np.ones((64, 128, 3)))
    many = dome(1000, 0)
    mean = np.mean([as_light(relight(sphere, light), space) for light in many], axis=0)
    assert relight_by_many(sphere, lights) == pytest.approx(mean, abs=5e-3)


def test_the_mean_of_a_polynomial_is_known() -> None:
    """Over the half-sphere u² and v² have the mean 1/3, all other terms but the constant 0."""
    lights = environment_lights(np.ones((128, 256, 3)))
    assert light_weights(PTM, lights) == pytest.approx(
        np.repeat([[1 / 3], [1 / 3], [0], [0], [0], [1]], 3, axis=1), abs=1e-4
    )
    harmonics = np.eye(9)[0] * 1 / np.sqrt(2 * np.pi)
    assert light_weights(Basis("hsh", 9), lights)[:, 0] == pytest.approx(harmonics, abs=1e-3)


def test_a_lambert_surface_under_an_even_sky_is_as_bright_as_it_is_open() -> None:
    """Half the albedo where it faces the camera, and (1 + n_z)/4 of it where it is turned."""
    sphere = lambert(NORMALS, Basis("hsh", 9), "linear")
    expected = 0.7 * TINT * (1 + NORMALS[..., 2:]) / 4
    seen = relight_by_many(sphere, environment_lights(np.ones((64, 128, 3))))
    assert seen == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize("space", ["srgb", "linear"])
def test_a_single_bright_texel_is_a_light(space: Space) -> None:
    sphere = lambert(NORMALS, space=space)
    panorama = np.zeros((64, 128, 3))
    panorama[20, 50] = [5000, 4000, 3000]
    lights = environment_lights(panorama)
    expected = as_light(relight(sphere, lights.directions[0]), space) * lights.colours[0]
    assert expected.max() > 0.5
    assert relight_by_many(sphere, lights) == pytest.approx(expected, abs=1e-5)


def test_gathered_lights_show_what_all_of_them_do() -> None:
    """A sky with a sun and a floor: no display value is off by as much as one of 255."""
    y, x = np.mgrid[:32, :64]
    sky = np.where((y < 16)[..., None], [0.3, 0.5, 1.0], [0.3, 0.2, 0.1]) + 0.0
    sky += 40 * np.exp(-((x - 22) ** 2 + (y - 12) ** 2) / 4)[..., None] * [1, 0.8, 0.5]
    lights = environment_lights(sky)
    assert len(lights.directions) > 1000
    sphere = lambert(NORMALS)
    every = sum(as_light(relight(sphere, d), "srgb") * c for d, c in zip(*lights, strict=True))
    difference = encode_srgb(relight_by_many(sphere, lights)) - encode_srgb(np.asarray(every))
    assert np.abs(difference).max() < 1 / 255


def test_highlights_of_an_environment_add_up_too() -> None:
    lights = Lights(dome(400), np.full((400, 3), 1 / 400))
    flat = lambert(np.broadcast_to([0.0, 0, 1], (1, 1, 3)), space="linear")
    gloss = Highlight(np.array([[[0, 0, 1]]], np.float32), 0.5, 10)
    added = relight_by_many(flat, lights, gloss) - relight_by_many(flat, lights)
    expected = np.mean([gloss.under(light)[0, 0] for light in lights.directions])
    assert added == pytest.approx(expected, rel=0.02)


def test_rows_are_reported_to_the_last() -> None:
    steps: list[Progress] = []
    tall = Ptm(np.zeros((6, 150, 1, 1), np.float32), np.ones((150, 1, 3), np.float32))
    relight_by_many(tall, TWO, report=steps.append)
    assert [step.done for step in steps] == [64, 128, 150]
