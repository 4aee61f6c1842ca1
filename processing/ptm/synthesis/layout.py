"""Where the blocks of a result stand, and which part of each is known when its turn comes."""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

Mask = NDArray[np.bool_]


class Edges(NamedTuple):
    """How many rows or columns of a block overlap blocks that are there already; 0 where none is."""

    left: int = 0
    top: int = 0
    right: int = 0
    bottom: int = 0


class Cell(NamedTuple):
    """A block's place: its upper left pixel, and what of it is known."""

    y: int
    x: int
    edges: Edges


@dataclass(frozen=True)
class Layout:
    """Blocks in the order in which they are chosen, row by row.

    Attributes
    ----------
    shape : height and width of the canvas; blocks of a tile go round its ends, others end at them
    block_px : side of a block
    cells : every block
    """

    shape: tuple[int, int]
    block_px: int
    cells: tuple[Cell, ...]


@cache
def known_part(edges: Edges, block_px: int) -> Mask:
    """Return the causal neighbourhood N_W (B, B) inside a block."""
    known = np.zeros((block_px, block_px), bool)
    known[:, : edges.left] = known[: edges.top] = True
    known[:, block_px - edges.right :] = known[block_px - edges.bottom :] = True
    known.setflags(write=False)
    return known


def plain_layout(height: int, width: int, block_px: int, overlap_px: int) -> Layout:
    """Cover a picture; the canvas is as much larger as the last blocks stand over."""
    step = block_px - overlap_px
    rows, columns = (max(1, ceil((side - overlap_px) / step)) for side in (height, width))
    cells = tuple(
        Cell(i * step, j * step, Edges(left=overlap_px if j else 0, top=overlap_px if i else 0))
        for i in range(rows)
        for j in range(columns)
    )
    return Layout(((rows - 1) * step + block_px, (columns - 1) * step + block_px), block_px, cells)


def tile_layout(height: int, width: int, block_px: int, overlap_px: int) -> Layout:
    """Cover a torus of any size: the last blocks overlap the first. Overlaps are wider where steps do not fit.

    Raises
    ------
    InputError
        The tile is smaller than a block, or the overlaps of a block's two sides would meet.
    """
    rows, columns = (_round_steps(side, block_px, overlap_px) for side in (height, width))
    cells = []
    for i, (y, above, below) in enumerate(rows):
        for j, (x, before, after) in enumerate(columns):
            last_row, last_column = i == len(rows) - 1, j == len(columns) - 1
            edges = Edges(before if j else 0, above if i else 0, after if last_column else 0, below if last_row else 0)
            cells.append(Cell(y, x, edges))
    return Layout((height, width), block_px, tuple(cells))


def _round_steps(side_px: int, block_px: int, overlap_px: int) -> list[tuple[int, int, int]]:
    """Return each block's start, and its overlaps with the one before and the one after."""
    if side_px < block_px:
        raise InputError(
            f"a tile of {side_px} pixels is smaller than a block of {block_px}; choose --block {side_px} or less, or a "
            "larger --size"
        )
    count = ceil(side_px / (block_px - overlap_px))
    starts = [i * side_px // count for i in range(count + 1)]
    overlaps = [block_px - (end - start) for start, end in pairwise(starts)]
    if any(before + after > block_px for before, after in pairwise([overlaps[-1], *overlaps])):
        raise InputError(
            f"a tile of {side_px} pixels makes blocks of {block_px} overlap by {max(overlaps)}, more than half; choose "
            f"--overlap {max(1, block_px // 4)} or less"
        )
    return [(starts[i], overlaps[i - 1], overlaps[i]) for i in range(count)]
