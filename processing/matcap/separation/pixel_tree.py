"""Pixels of a disc in tiles of tiles, so that what holds for a tile need not be asked of every pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel

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
        begins = np.concatenate([[0], np.flatnonzero(tiles[1:] != tiles[:-1]) + 1, [len(tiles)]])
        middles, reaches = np.zeros((len(begins) - 1, 3)), np.zeros(len(begins) - 1)
        _measure(normals, begins, middles, reaches)
        starts.append(begins)
        centres.append(middles)
        radii.append(reaches)
    return PixelTree(normals, codes, tuple(starts), tuple(centres), tuple(radii))


@kernel
def _measure(normals: F64, begins: Integers, middles: F64, reaches: F64) -> None:
    for tile in range(len(reaches)):
        x, y, z = 0.0, 0.0, 0.0
        for i in range(begins[tile], begins[tile + 1]):
            x, y, z = x + normals[i, 0], y + normals[i, 1], z + normals[i, 2]
        length = np.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
        farthest = 0.0
        for i in range(begins[tile], begins[tile + 1]):
            dx, dy, dz = normals[i, 0] - x, normals[i, 1] - y, normals[i, 2] - z
            farthest = max(farthest, dx * dx + dy * dy + dz * dz)
        middles[tile, 0], middles[tile, 1], middles[tile, 2] = x, y, z
        reaches[tile] = np.sqrt(farthest)


def _spread(values: Integers) -> Integers:
    """Put a zero after each bit of numbers below 2¹⁶."""
    spread = values
    for shift, mask in _SPREADING:
        spread = (spread | (spread << shift)) & mask
    return spread
