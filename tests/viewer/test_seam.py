"""Where k jumps from 1 to 0 no pixel shows it (the AMC paper, section 6.2)."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from litrig.base.radiometry import encode_srgb
from processing.amc.model import Amc
from processing.mesh.builtin import builtin_mesh
from processing.mesh.model import Mesh
from tests.viewer.analytic import brushed_amc
from viewer.materials.amc import amc_picture
from viewer.renderer import Renderer
from viewer.view import Projection, View

SIZE = (512, 512)


def half_a_turn_on(amc: Amc, mesh: Mesh) -> tuple[Amc, Mesh]:
    """The same material on the same mesh, described half a turn further: k jumps elsewhere."""
    shift = len(amc.slices) // 2
    turned = dataclasses.replace(
        amc, slices=np.roll(amc.slices, shift, axis=0), valid=np.roll(amc.valid, shift, axis=0)
    )
    return turned, dataclasses.replace(mesh, tangents=-mesh.tangents)


def spread_out(amc: Amc) -> Amc:
    """The same table without making use of its invariance: every slice R times in a turn."""
    return dataclasses.replace(
        amc, slices=np.tile(amc.slices, (2, 1, 1, 1)), valid=np.tile(amc.valid, (2, 1, 1)), invariance=1
    )


def pixels_apart(first: NDArray[np.float32], second: NDArray[np.float32]) -> int:
    codes = np.abs(encode_srgb(first[..., :3]) - encode_srgb(second[..., :3])) * 255
    return int(np.count_nonzero(codes.max(axis=-1) > 2))


@pytest.mark.parametrize("projection", Projection)
@pytest.mark.parametrize("name", ["torus", "sphere", "cloth"])
def test_no_pixel_shows_where_k_jumps(renderer: Renderer, name: str, projection: Projection) -> None:
    amc, mesh, view = brushed_amc(64, 64, 1), builtin_mesh(name), View(projection, yaw_deg=20, pitch_deg=30)
    elsewhere, turned = half_a_turn_on(amc, mesh)
    here = amc_picture(renderer, amc, mesh, view, size=SIZE)
    there = amc_picture(renderer, elsewhere, turned, view, size=SIZE)
    assert pixels_apart(here, there) == 0


def test_without_the_trick_hundreds_of_pixels_show_it(renderer: Renderer) -> None:
    amc, mesh, view = brushed_amc(64, 64, 1), builtin_mesh("torus"), View(yaw_deg=20, pitch_deg=30)
    right = amc_picture(renderer, amc, mesh, view, size=SIZE)
    wrong = amc_picture(renderer, amc, mesh, view, size=SIZE, seam_trick=False)
    assert pixels_apart(right, wrong) > 200
    elsewhere, turned = half_a_turn_on(amc, mesh)
    assert pixels_apart(wrong, amc_picture(renderer, elsewhere, turned, view, size=SIZE, seam_trick=False)) > 200


def test_without_mipmaps_there_is_no_seam_to_remove(renderer: Renderer) -> None:
    amc, mesh, view = brushed_amc(64, 64, 1), builtin_mesh("torus"), View(yaw_deg=20, pitch_deg=30)
    pictures = [amc_picture(renderer, amc, mesh, view, size=SIZE, level=0, seam_trick=trick) for trick in (True, False)]
    np.testing.assert_array_equal(pictures[0], pictures[1])


@pytest.mark.parametrize("name", ["torus", "cloth"])
def test_a_table_that_repeats_twice_a_turn_shows_no_seam_either(renderer: Renderer, name: str) -> None:
    """The same slices laid out over the whole turn, and half a turn on, are the truth."""
    amc, mesh, view = brushed_amc(64, 32, 2), builtin_mesh(name), View(yaw_deg=20, pitch_deg=30)
    elsewhere, turned = half_a_turn_on(spread_out(amc), mesh)
    here = amc_picture(renderer, amc, mesh, view, size=SIZE)
    there = amc_picture(renderer, elsewhere, turned, view, size=SIZE)
    assert pixels_apart(here, there) == 0
    assert pixels_apart(here, amc_picture(renderer, amc, mesh, view, size=SIZE, seam_trick=False)) > 20
