"""Blocks cover what they are to cover, and what a layout calls known is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from litrig.base.errors import InputError
from processing.ptm.synthesis.layout import Layout, known_part, plain_layout, tile_layout

SIDES = st.integers(1, 90)


def lay(layout: Layout) -> np.ndarray:
    """Lay the blocks, and see before each that the known part is what has been laid."""
    laid = np.zeros(layout.shape, bool)
    for y, x, edges in layout.cells:
        place = np.ix_(
            (y + np.arange(layout.block_px)) % laid.shape[0], (x + np.arange(layout.block_px)) % laid.shape[1]
        )
        np.testing.assert_array_equal(laid[place], known_part(edges, layout.block_px))
        laid[place] = True
    return laid


@given(SIDES, SIDES, st.integers(4, 30), st.data())
@settings(max_examples=40, deadline=None)
def test_a_picture_of_any_size_is_covered(height: int, width: int, block_px: int, data: st.DataObject) -> None:
    layout = plain_layout(height, width, block_px, data.draw(st.integers(1, block_px // 2)))
    assert lay(layout).all()
    assert layout.shape[0] >= height
    assert layout.shape[1] >= width


@given(st.integers(0, 60), st.integers(0, 60), st.integers(4, 30), st.data())
@settings(max_examples=40, deadline=None)
def test_a_tile_of_any_size_is_covered_round_its_ends(
    more_h: int, more_w: int, block_px: int, data: st.DataObject
) -> None:
    height, width = block_px + more_h, block_px + more_w
    layout = tile_layout(height, width, block_px, data.draw(st.integers(1, max(1, block_px // 4))))
    assert layout.shape == (height, width)
    assert lay(layout).all()
    assert all(cell.edges.left + cell.edges.right <= block_px for cell in layout.cells)


def test_the_usual_layout_has_484_blocks() -> None:
    assert len(plain_layout(512, 512, 30, 6).cells) == 484


def test_a_tile_smaller_than_a_block_is_refused() -> None:
    with pytest.raises(InputError, match="a tile of 29 pixels is smaller than a block of 30; choose --block 29"):
        tile_layout(64, 29, 30, 6)


def test_overlaps_of_more_than_half_are_refused() -> None:
    with pytest.raises(InputError, match="more than half; choose --overlap 7 or less"):
        tile_layout(31, 31, 30, 15)
