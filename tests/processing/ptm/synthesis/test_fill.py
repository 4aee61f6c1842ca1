"""Holes are filled from their borders inwards, and nothing else is touched."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.errors import InputError
from processing.ptm.synthesis.fill import fill
from processing.ptm.synthesis.settings import Join, Synthesis
from tests.processing.ptm.synthesis.textures import bits, rough

SMALL = Synthesis(16, 4)


def round_hole(side_px: int, radius_px: float) -> NDArray[np.bool_]:
    y, x = np.mgrid[:side_px, :side_px]
    return np.asarray(np.hypot(y - side_px / 2, x - side_px / 3) < radius_px, bool)


HOLES = {
    "round": round_hole(64, 15),
    "in a corner": np.pad(np.ones((20, 11), bool), ((0, 44), (53, 0))),
    "one pixel": np.pad(np.ones((1, 1), bool), ((40, 23), (0, 63))),
    "a line across": np.pad(np.ones((1, 64), bool), ((30, 33), (0, 0))),
}


@pytest.mark.parametrize("join", ["cut", "blend"])
@pytest.mark.parametrize("name", HOLES)
def test_a_hole_is_filled_and_what_is_far_from_it_kept(name: str, join: Join) -> None:
    whole, hole = rough(64), HOLES[name]
    broken = replace(whole, coefficients=np.where(hole[..., None], np.float32(9), whole.coefficients))
    filled = fill([broken], hole, replace(SMALL, join=join)).material
    far = ~ndimage.binary_dilation(hole, iterations=4)
    np.testing.assert_array_equal(filled.coefficients[:, far], whole.coefficients[:, far])
    assert np.abs(filled.coefficients).max() <= np.abs(whole.coefficients).max()
    if join == "cut":
        known = {row.tobytes() for row in whole.coefficients[:, ~hole].reshape(6, -1).T}
        assert {row.tobytes() for row in filled.coefficients.reshape(6, -1).T} <= known


def test_what_lies_in_a_hole_may_be_no_number() -> None:
    whole, hole = rough(64), HOLES["round"]
    broken = replace(whole, coefficients=np.where(hole[..., None], np.float32(np.nan), whole.coefficients))
    assert np.isfinite(fill([broken], hole, SMALL).material.coefficients).all()


def test_the_border_hardly_shows() -> None:
    """Steps across the border are as those of the material, not as those to anything at random."""
    whole, hole = rough(96, blur_px=2.5), round_hole(96, 22)
    filled = fill([whole], hole, SMALL).material.coefficients[5, ..., 0]
    rolled = np.where(hole, np.roll(whole.coefficients[5, ..., 0], 40, axis=1), whole.coefficients[5, ..., 0])
    across = np.diff(hole, axis=1)
    ordinary = np.abs(np.diff(whole.coefficients[5, ..., 0], axis=1))[~across].mean()
    assert np.abs(np.diff(filled, axis=1))[across].mean() < 2 * ordinary
    assert np.abs(np.diff(rolled, axis=1))[across].mean() > 3 * ordinary


def test_fft_and_brute_force_fill_alike_and_a_seed_repeats_it() -> None:
    whole, hole = rough(64), HOLES["round"]
    one, again = (bits(fill([whole], hole, replace(SMALL, search=search)).material) for search in ("fft", "brute"))
    np.testing.assert_array_equal(one, again)
    assert (bits(fill([whole], hole, replace(SMALL, seed=1)).material) != one).any()


def test_a_hole_with_no_block_beside_it_is_filled_from_another_source() -> None:
    hole = np.ones((20, 20), bool)
    hole[:, 0] = False
    other = rough(40, seed=7)
    filled = fill([rough(20), other], hole, SMALL).material
    assert set(filled.coefficients[5, :, 10:].ravel()) <= set(other.coefficients[5].ravel())
    with pytest.raises(InputError, match="no block of 16 pixels lies outside the mask"):
        fill([rough(20)], hole, SMALL)


def test_an_empty_mask_and_a_tile_are_refused() -> None:
    with pytest.raises(InputError, match="marks no pixel"):
        fill([rough(40)], np.zeros((40, 40), bool), SMALL)
    with pytest.raises(InputError, match="is no tile"):
        fill([rough(40)], round_hole(40, 5), replace(SMALL, tileable=True))
    with pytest.raises(InputError, match="--search fft or brute"):
        fill([rough(40)], round_hole(40, 5), replace(SMALL, search="svd"))
