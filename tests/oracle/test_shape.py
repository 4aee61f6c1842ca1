"""Pictures whose surfaces are edited after rendering come near those that mitsuba renders anew.

One cell of each table; `make oracle` measures them all. Everything goes through the commands and mitsuba's own files.
"""

from pathlib import Path

import pytest

from firmware_sim.mitsuba.variants import FAST
from tests.oracle.shape_measure import TABLE_TOP, Quality, edit, neighbours, on_a_floor, rebuilt, residuals

MARGIN_DB = 3
"""Over the better of leaving the shading alone and of shading its diffuse part alone."""


@pytest.fixture(scope="module")
def folder(variant: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    if variant != FAST:
        pytest.skip("what tells lobes apart is a program in Python, which takes minutes a picture without LLVM")
    return tmp_path_factory.mktemp("shape")


def test_a_teapot_tells_the_light_that_a_ball_of_its_material_would_show(variant: str, folder: Path) -> None:
    found = rebuilt(Quality(variant, 80, 384, folder), "teapot", "windows")
    assert found.coverage > 0.8
    assert found.diffuse.error(found.diffuse.told) < 0.25
    assert found.reflection.error(found.reflection.told) < 0.25
    upside_down = found.reflection._replace(ours=found.reflection.ours[::-1])
    assert upside_down.error(found.reflection.told) > 0.5


def test_diffuse_light_of_what_shadows_itself_is_held_under_every_pixel(variant: str, folder: Path) -> None:
    quality = Quality(variant, 64, 128, folder)
    qp, least_squares = (residuals(quality, "torus", "soft", method) for method in ("qp", "ls"))
    assert qp.brightest < 1e-5
    assert least_squares.brightest > 0.05
    assert least_squares.bias < qp.bias


def test_bumps_that_are_made_after_rendering_come_near_bumps_that_are_rendered(variant: str, folder: Path) -> None:
    found = edit(Quality(variant, 64, 128, folder), on_a_floor("sphere", "windows"), 0, "floor")
    assert found.others_kept
    assert found.margin_db >= MARGIN_DB


def test_an_edited_thing_goes_on_mirroring_the_others_and_those_keep_their_bits(variant: str, folder: Path) -> None:
    found, among = neighbours(Quality(variant, 48, 64, folder), TABLE_TOP, 0, "table")
    assert found.others_kept
    assert found.margin_db >= MARGIN_DB
    assert among.environment > 0.5
    assert among.edited > among.alone
