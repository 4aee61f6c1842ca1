"""Pixels of a disc in tiles of tiles, so that what holds for a tile need not be asked of every pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Integers = NDArray[np.int64]

_TILE_PX = 4
"""Side of the smallest tiles; each larger one holds four by four."""
_LEVELS = 4
_SPREADING = ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555))


@dataclass(frozen=True)
class PixelTree:
    """Normals in an order in which each tile is a run, at every level.

    Attributes
    ----------
    normals : (N, 3) unit
    codes : (N,) the smallest tile of each, never falling; a quarter of the bits less for each level above
    starts : per level, coarsest first: (T + 1,) where tiles begin
    centres : per level (T, 3) unit, in the middle of the tile's normals
    radii : per level (T,) the largest distance of a tile's normals from its centre
    """

    normals: F64
    codes: Integers
    starts: tuple[Integers, ...]
    centres: tuple[F64, ...]
    radii: tuple[F64, ...]

    def part(self, chosen: NDArray[np.bool_]) -> "PixelTree":
        """Return the tree of some of the normals, by a mask (N,)."""
        return _grown(self.normals[chosen], self.codes[chosen])


def tile_order(rows: Integers, columns: Integers) -> tuple[Integers, Integers]:
    """Return the order in which tiles of pixels (N,) are runs, and the codes of the tiles in that order."""
    codes = _spread(columns // _TILE_PX) | (_spread(rows // _TILE_PX) << 1)
    order = np.argsort(codes, kind="stable")
    return order, codes[order]


def grow_tree(normals: F64, codes: Integers) -> PixelTree:
    """Make a tree of normals (N, 3) that are in the order of their tiles' codes (N,)."""
    return _grown(np.ascontiguousarray(normals), codes)


def _grown(normals: F64, codes: Integers) -> PixelTree:
    starts, centres, radii = [], [], []
    for level in reversed(range(_LEVELS)):
        tiles = codes >> (4 * level)
        first = np.flatnonzero(np.diff(tiles, prepend=-1))
        middle = np.add.reduceat(normals, first, axis=0)
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        sizes = np.diff(first, append=len(normals))
        off = normals - np.repeat(middle, sizes, axis=0)
        starts.append(np.append(first, len(normals)))
        centres.append(middle)
        radii.append(np.sqrt(np.maximum.reduceat(np.einsum("ij,ij->i", off, off), first)))
    return PixelTree(normals, codes, tuple(starts), tuple(centres), tuple(radii))


def _spread(values: Integers) -> Integers:
    """Put a zero after each bit of numbers below 2¹⁶."""
    spread = values
    for shift, mask in _SPREADING:
        spread = (spread | (spread << shift)) & mask
    return spread
