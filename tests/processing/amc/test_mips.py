"""Smaller levels of an AMC: area means, in light, over what was seen, and closed round k."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.amc.mips import area_weights, mip_chain
from processing.amc.model import Amc


@given(st.integers(2, 40))
def test_every_cell_is_shared_out_whole(count: int) -> None:
    shares = area_weights(count, count // 2)
    np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(shares.sum(axis=0), (count // 2) / count, atol=1e-6)


def test_five_slices_become_two_that_cover_two_and_a_half_each() -> None:
    np.testing.assert_allclose(area_weights(5, 2), [[0.4, 0.4, 0.2, 0, 0], [0, 0, 0.2, 0.4, 0.4]], atol=1e-6)


@pytest.mark.parametrize(
    ("size", "depth", "shapes"),
    [
        pytest.param(4, 8, [(8, 4), (4, 2), (2, 1), (1, 1)], id="powers of two, deeper than wide"),
        pytest.param(6, 5, [(5, 6), (2, 3), (1, 1)], id="odd depth"),
        pytest.param(8, 1, [(1, 8), (1, 4), (1, 2), (1, 1)], id="isotropic"),
    ],
)
def test_levels_halve_all_three_sides(size: int, depth: int, shapes: list[tuple[int, int]]) -> None:
    amc = Amc(np.zeros((depth, size, size, 3), np.float32), np.ones((depth, size, size), bool), 1)
    assert [level.colours.shape[:2] for level in mip_chain(amc)] == shapes


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 99))
def test_the_last_level_is_the_mean_of_what_was_seen(size: int, depth: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    amc = Amc(random.random((depth, size, size, 3), np.float32), random.random((depth, size, size)) > 0.5, 1)
    last = mip_chain(amc)[-1]
    seen = amc.slices[amc.valid] if amc.valid.any() else amc.slices.reshape(-1, 3)
    np.testing.assert_allclose(last.colours[0, 0, 0], seen.mean(axis=0), rtol=2e-5)
    np.testing.assert_allclose(last.coverage[0, 0, 0], amc.valid.mean(), atol=1e-6)


def test_what_was_not_seen_does_not_colour_its_neighbours() -> None:
    slices = np.zeros((1, 2, 2, 3), np.float32)
    slices[0, 0, 0] = 0.5
    slices[0, 1, 1] = 1000
    valid = np.ones((1, 2, 2), bool)
    valid[0, 1, 1] = False
    np.testing.assert_allclose(mip_chain(Amc(slices, valid, 1))[1].colours[0, 0, 0], 0.5 / 3, rtol=1e-6)


def test_a_whole_turn_of_an_even_table_moves_with_it() -> None:
    """Turning the table by two slices turns its first smaller level by one: no seam is built in."""
    random = np.random.default_rng(3)
    slices = random.random((8, 4, 4, 3), np.float32)
    valid = np.ones((8, 4, 4), bool)
    turned = mip_chain(Amc(np.roll(slices, 2, axis=0), valid, 1))[1].colours
    np.testing.assert_allclose(turned, np.roll(mip_chain(Amc(slices, valid, 1))[1].colours, 1, axis=0), rtol=1e-6)
