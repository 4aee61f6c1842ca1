"""Smaller and smaller copies of an AMC, so that a renderer can read it where it is seen small.

Every level halves columns, rows and slices, rounded down, as graphics interfaces expect of a volume. Each new texel is
the mean over exactly the part of the table that it covers; that holds for odd counts too (5 slices, then 2, then 1).
Along k the table is one whole period, so that the cells of every level close round it without a gap.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.amc.model import Amc

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class MipLevel:
    """One level of the pyramid.

    Attributes
    ----------
    colours : (D, S, S, 3) float32, linear light, axes as in `Amc.slices`
    coverage : (D, S, S) float32, 0..1, the valid share of what a texel stands for; 0 or 1 in level 0
    """

    colours: F32
    coverage: F32


def level_count(size: int, depth: int) -> int:
    """Count the levels down to a single texel."""
    return max(size, depth).bit_length()


def mip_chain(amc: Amc) -> list[MipLevel]:
    """Build all levels, the full one first, in linear light and weighted by validity."""
    levels = [first_level(amc)]
    for _ in range(level_count(amc.slices.shape[1], amc.slices.shape[0]) - 1):
        levels.append(_halve(levels[-1]))
    return levels


def first_level(amc: Amc) -> MipLevel:
    """Return the table itself as level 0."""
    return MipLevel(np.asarray(amc.slices, np.float32), amc.valid.astype(np.float32))


def area_weights(source: int, target: int) -> F32:
    """Return the shares (target, source) of source cells in target cells; every row sums to one."""
    edges = np.arange(target + 1)[:, None] * source / target
    cells = np.arange(source)[None, :]
    reached = np.clip(edges - cells, 0, 1)
    shares = np.diff(reached, axis=0) * target / source
    return shares.astype(np.float32)


def _halve(level: MipLevel) -> MipLevel:
    """Shrink slice by slice first, so that no whole level is held twice."""
    depth, height, width = level.coverage.shape
    small = (depth, max(1, height // 2), max(1, width // 2))
    seen, dilated = np.zeros((*small, 3), np.float32), np.zeros((*small, 3), np.float32)
    coverage = np.zeros(small, np.float32)
    for j, (colours, covered) in enumerate(zip(level.colours, level.coverage, strict=True)):
        seen[j] = _shrink(colours * covered[..., None], axes=(0, 1))
        dilated[j], coverage[j] = _shrink(colours, axes=(0, 1)), _shrink(covered, axes=(0, 1))
    seen, dilated, coverage = (_shrink(part, axes=(0,)) for part in (seen, dilated, coverage))
    # Where nothing was seen the dilated colours are all there is to average.
    some = coverage[..., None] > 0
    colours = np.where(some, seen / np.where(some, coverage[..., None], 1), dilated)
    return MipLevel(colours.astype(np.float32), coverage)


def _shrink(table: F32, axes: tuple[int, ...]) -> F32:
    """Halve some axes."""
    for axis in axes:
        count = table.shape[axis]
        if count > 1:
            shrunk = np.tensordot(area_weights(count, count // 2), table, axes=(1, axis))
            table = np.moveaxis(shrunk, 0, axis)
    return np.ascontiguousarray(table, np.float32)
