"""What each step of a recipe does to a decomposed MatCap."""

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.matcap.matcap_exr import write_matcap
from processing.matcap.model import DecomposedMatcap
from processing.matcap.recipe.apply import apply_recipe
from processing.matcap.recipe.lighting import highlight_direction
from processing.matcap.recipe.operations import (
    Align,
    Colour,
    Gain,
    Hang,
    Move,
    One,
    Operation,
    Outline,
    Paint,
    Rotate,
    Roughness,
    Take,
    Which,
)
from processing.matcap.recipe.recipe_toml import Recipe
from processing.matcap.render import disc_picture
from processing.paraboloid.blur import blurred
from tests.processing.matcap.maps import analytic

MATCAP = dataclasses.replace(analytic(48), picture_size=40)


def done(*steps: Operation, folder: Path = Path(), matcap: DecomposedMatcap = MATCAP) -> DecomposedMatcap:
    return apply_recipe(matcap, Recipe(steps=steps), folder)


def brightest(picture: NDArray[np.float32]) -> tuple[float, float]:
    """x and y of the brightest pixel."""
    row, column = np.unravel_index(np.argmax(picture.sum(axis=-1)), picture.shape[:2])
    side = picture.shape[0]
    return (2 * column + 1) / side - 1, 1 - (2 * row + 1) / side


def test_nothing_done_changes_nothing() -> None:
    assert done() is MATCAP


def test_turns_add_up_and_a_whole_one_comes_back() -> None:
    one = done(Rotate(axis="y", degrees=20), Rotate(axis="y", degrees=25))
    assert one.low.light_turn_deg == pytest.approx((0, 45, 0))
    assert one.high.light_turn_deg == one.low.light_turn_deg
    whole = done(*[Rotate(axis=(1.0, 2.0, -1.0), degrees=120)] * 3)
    np.testing.assert_allclose(disc_picture(whole), disc_picture(MATCAP), atol=1e-6)


def test_light_that_turns_about_y_goes_to_the_right() -> None:
    spot = done(Gain(low=0, high=0.0001), Paint(at=(0.0, 0.0), size_deg=4, colour=(1e4, 1e4, 1e4)))
    x, y = brightest(disc_picture(done(Rotate(axis="y", degrees=30), matcap=spot), 200))
    # A direction at 30 degrees is seen at 30/(1 + μ).
    assert x == pytest.approx(np.sin(np.radians(30 / 1.9)), abs=0.02) and abs(y) < 0.02


@pytest.mark.parametrize("at", [(0.0, 0.0), (-0.5, 0.3), (0.6, -0.6)])
def test_what_is_painted_is_seen_where_it_was_painted_also_under_turned_light(at: tuple[float, float]) -> None:
    turned = done(Rotate(axis="x", degrees=70), Gain(low=0, high=1e-4), Paint(at=at, size_deg=4, colour=(1e4,) * 3))
    assert brightest(disc_picture(turned, 200)) == pytest.approx(at, abs=0.03)


def test_a_line_and_an_edge_go_where_they_are_told() -> None:
    dark = done(Gain(low=0, high=1e-3))
    line = disc_picture(
        done(Paint(shape="line", at=(-0.5, 0.0), to=(0.5, 0.0), size_deg=3, colour=(1e3,) * 3), matcap=dark), 41
    )
    assert line[20, 12:29].min() > 0.15 and line[10].max() < 0.1 and line[20, 3].max() < 0.1
    edge = disc_picture(done(Paint(shape="edge", at=(0.0, 0.0), to=(0.0, 0.5), colour=(1e3,) * 3), matcap=dark), 41)
    assert edge[8, 20].min() > 0.55 and edge[32, 20].max() < 0.1
    assert edge[20, 20, 0] == pytest.approx(edge[8, 20, 0] / 2, abs=0.1)


def test_a_picture_hangs_and_is_moved_by_its_name(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "flame.png"), np.full((8, 8, 3), 255, np.uint8))
    dark = done(Gain(low=0, high=1e-4))
    first = Hang(image="flame.png", at=(-0.4, 0.0), size_deg=20, colour=(1e4,) * 3, name="flame")
    there = done(first, matcap=dark, folder=tmp_path)
    assert brightest(disc_picture(there, 100))[0] == pytest.approx(-0.4, abs=0.15)
    moved = done(Move(name="flame", at=(0.4, 0.2), size_deg=10), matcap=there)
    assert brightest(disc_picture(moved, 100)) == pytest.approx((0.4, 0.2), abs=0.15)
    assert moved.high.pictures[0].picture.size_deg == 10
    again = done(first.model_copy(update={"at": (0.0, 0.5)}), matcap=moved, folder=tmp_path)
    assert len(again.high.pictures) == 1
    with pytest.raises(InputError, match="no picture hangs under the name 'smoke'"):
        done(Move(name="smoke"), matcap=there)
    with pytest.raises(InputError, match=r"soot\.png: no such file"):
        done(Hang(image="soot.png", at=(0.0, 0.0)), folder=tmp_path)


def test_a_rougher_material_has_blurred_maps_and_a_smaller_slope() -> None:
    found = done(Roughness(component=Which.HIGH, filter_size=0.12)).high
    wanted = blurred(MATCAP.high.front, MATCAP.high.back, 0.12 - MATCAP.high.filter_size)
    np.testing.assert_allclose(found.front, wanted[0], rtol=5e-4, atol=1e-6)  # half floats
    assert found.filter_size == 0.12
    # Its slope was .9 though μ(.02) is .99356: it stays as far below.
    assert found.slope == pytest.approx(0.9 + (1 - 0.3 * 0.12 - 1.1 * 0.12**2) - (1 - 0.3 * 0.02 - 1.1 * 0.02**2))
    assert done(Roughness(degrees=np.degrees(np.sqrt(0.02)))).high.front is not MATCAP.low.front


def test_a_shinier_material_has_steeper_maps_and_a_larger_slope() -> None:
    found = done(Roughness(filter_size=0.005)).high
    assert found.front.max() > 1.15 * MATCAP.high.front.max()
    assert found.slope > MATCAP.high.slope
    assert done(Roughness(filter_size=0.005)).low is MATCAP.low


def test_colours_turn_fade_and_brighten() -> None:
    red = done(Colour(base_colour=(0.8, 0.2, 0.2)))
    assert red.low.base_colour == red.high.base_colour == (0.8, 0.2, 0.2)
    assert done(Colour(hue_deg=120), matcap=red).low.base_colour == pytest.approx((0.2, 0.8, 0.2))
    assert done(Colour(saturation=0), matcap=red).low.base_colour == pytest.approx((0.8, 0.8, 0.8))
    assert done(Colour(saturation=100), matcap=red).low.base_colour == pytest.approx((0.8, 0, 0))
    half = done(Colour(value=0.5, component=Which.HIGH), matcap=red)
    assert half.high.base_colour == pytest.approx((0.4, 0.1, 0.1)) and half.low is red.low


def test_gains_scale_the_picture_with_its_silhouette() -> None:
    outlined = done(Outline(start_deg=20, rise=0.7, slope=1.0))
    np.testing.assert_allclose(
        disc_picture(done(Gain(low=0.5, high=0.5), matcap=outlined)), 0.5 * disc_picture(outlined), atol=1e-6
    )
    assert disc_picture(outlined).sum() > 1.1 * disc_picture(MATCAP).sum()


def test_components_are_mixed(tmp_path: Path) -> None:
    other = analytic(64, slopes=(0.2, 0.7))
    write_matcap(tmp_path / "b.matcap.exr", other)
    mixed = done(Take(component=One.HIGH, from_file="b.matcap.exr"), folder=tmp_path)
    assert mixed.high.slope == 0.7 and mixed.low.slope == MATCAP.low.slope
    np.testing.assert_array_equal(mixed.high.front, other.high.front)
    assert mixed.low.front.shape == mixed.high.front.shape
    alone = disc_picture(done(Gain(high=0))), disc_picture(done(Gain(low=0), matcap=other), 40)
    np.testing.assert_allclose(disc_picture(mixed), alone[0] + alone[1], atol=0.02)


def test_main_highlights_are_aligned(tmp_path: Path) -> None:
    other = done(Rotate(axis=(0.3, 1.0, 0.2), degrees=50), matcap=analytic(48, slopes=(0.2, 0.7)))
    write_matcap(tmp_path / "b.matcap.exr", other)
    assert highlight_direction(MATCAP) @ highlight_direction(other) < 0.8
    aligned = done(Align(to_file="b.matcap.exr"), folder=tmp_path)
    assert highlight_direction(aligned) @ highlight_direction(other) > 0.99999
    turned = done(Rotate(axis="z", degrees=80), matcap=aligned), done(Rotate(axis="z", degrees=80), matcap=other)
    assert highlight_direction(turned[0]) @ highlight_direction(turned[1]) > 0.99999
    seen = disc_picture(done(Align(at=(0.3, -0.2)), Gain(low=0)), 100)
    assert brightest(seen) == pytest.approx((0.3, -0.2), abs=0.06)


def test_the_main_highlight_is_the_brightest_lamp() -> None:
    towards = np.array([-0.5, 0.6, 0.62])
    assert highlight_direction(MATCAP) @ towards / np.linalg.norm(towards) > 0.999
