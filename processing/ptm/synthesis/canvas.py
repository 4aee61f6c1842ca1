"""The result while it grows: values, and where each came from."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from processing.ptm.synthesis.search.problem import Candidates

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]


class Taken(NamedTuple):
    """A block that was chosen: where it stands, and where in which source it comes from."""

    y: int
    x: int
    source: int
    source_y: int
    source_x: int


class Canvas:
    """Planes (H, W, P), in which blocks may go round the ends.

    Attributes
    ----------
    values : (H, W, P) float32
    block : (H, W) number of the block that a pixel is taken from, or has most of; −1 where none is
    mixed : (H, W), where blocks were blended and a pixel has values of its own
    taken : the blocks in their order
    """

    def __init__(self, shape: tuple[int, int], planes: int) -> None:
        self.values = np.zeros((*shape, planes), np.float32)
        self.block = np.full(shape, -1, np.int32)
        self.mixed = np.zeros(shape, bool)
        self.taken: list[Taken] = []

    def window(self, y: int, x: int, side: int) -> tuple[I64, I64] | tuple[slice, slice]:
        """Return what indexes a block's place."""
        height, width = self.block.shape
        if y + side <= height and x + side <= width:
            return slice(y, y + side), slice(x, x + side)
        rows, columns = np.ix_((y + np.arange(side)) % height, (x + np.arange(side)) % width)
        return rows, columns

    def put(self, taken: Taken, new: F32, weight: F32) -> None:
        """Lay a block (B, B, P) over what is there, with the weight (B, B) of the new."""
        place = self.window(taken.y, taken.x, len(weight))
        old = self.values[place]
        self.values[place] = np.where(weight[..., None] == 1, new, old + weight[..., None] * (new - old))
        number = len(self.taken)
        self.block[place] = np.where(weight >= 0.5, number, self.block[place])
        self.mixed[place] = np.where(weight == 1, False, self.mixed[place] | (weight > 0))
        self.taken.append(taken)

    def neighbours(self, y: int, x: int, side: int) -> list[Taken]:
        """Return the blocks that a new one would overlap."""
        numbers = np.unique(self.block[self.window(y, x, side)])
        return [self.taken[number] for number in numbers[numbers >= 0]]

    def continuations(self, y: int, x: int, candidates: Candidates, radius_px: int) -> I64:
        """Return the numbers of candidates that would go on with a source where a neighbour left off, or nearly so."""
        height, width = self.block.shape
        banned = [np.zeros(0, np.int64)]
        for near in self.neighbours(y, x, candidates.block_px):
            # Round a torus the shorter way.
            dy = (y - near.y + height // 2) % height - height // 2
            dx = (x - near.x + width // 2) % width - width // 2
            banned.append(candidates.around(near.source, near.source_y + dy, near.source_x + dx, radius_px))
        return np.unique(np.concatenate(banned))

    def turn(self, rows: int, columns: int) -> None:
        """Turn a torus so that a row and a column come first."""
        height, width = self.block.shape
        shift = (-rows, -columns)
        self.values = np.roll(self.values, shift, axis=(0, 1))
        self.block, self.mixed = np.roll(self.block, shift, (0, 1)), np.roll(self.mixed, shift, (0, 1))
        self.taken = [t._replace(y=(t.y - rows) % height, x=(t.x - columns) % width) for t in self.taken]

    def origins(self) -> tuple[I64, I64, I64]:
        """Return source, row and column (H, W) that each pixel is from; source −1 where none is."""
        height, width = self.block.shape
        places = np.array([(t.y, t.x, t.source, t.source_y, t.source_x) for t in self.taken] or [(0,) * 5], np.int64)
        y, x, source, source_y, source_x = np.moveaxis(places[self.block], -1, 0)
        rows = source_y + (np.arange(height)[:, None] - y) % height
        columns = source_x + (np.arange(width) - x) % width
        return np.where(self.block >= 0, source, -1), rows, columns
