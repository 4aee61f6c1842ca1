"""Smaller and smaller copies of an AMC, so that a renderer can read it where it is seen small.

Every level halves columns, rows and slices, rounded down, as graphics interfaces expect of a volume. Each new texel is
the mean over exactly the part of the table that it covers; that holds for odd counts too (5 slices, then 2, then 1).
Along k the table is one whole period, so that the cells of every level close round it without a gap.
"""

from dataclasses import dataclass

import cv2
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
    same = amc.valid.strides[0] == 0  # then one slice's validity stands for all, and takes the memory of one
    coverage = (amc.valid[:1] if same else amc.valid).astype(np.float32)
    return MipLevel(np.asarray(amc.slices, np.float32), np.broadcast_to(coverage, amc.valid.shape))


def area_weights(source: int, target: int) -> F32:
    """Return the shares (target, source) of source cells in target cells; every row sums to one."""
    edges = np.arange(target + 1)[:, None] * source / target
    cells = np.arange(source)[None, :]
    reached = np.clip(edges - cells, 0, 1)
    shares = np.diff(reached, axis=0) * target / source
    return shares.astype(np.float32)


def _halve(level: MipLevel) -> MipLevel:
    """Shrink slice by slice, so that no more than the result is held beside the level."""
    depth, height, width = level.coverage.shape
    small = (max(1, depth // 2), max(1, height // 2), max(1, width // 2))
    colours, coverage = np.zeros((*small, 3), np.float32), np.zeros(small, np.float32)
    for j, shares in enumerate(area_weights(depth, small[0])):
        seen, dilated = np.zeros_like(colours[j]), np.zeros_like(colours[j])
        for source in np.flatnonzero(shares):
            light, covered = level.colours[source], level.coverage[source]
            seen += shares[source] * shrink(light * covered[..., None])
            dilated += shares[source] * shrink(light)
            coverage[j] += shares[source] * shrink(covered)
        # Where nothing was seen the dilated colours are all there is to average.
        some = coverage[j][..., None] > 0
        colours[j] = np.where(some, seen / np.where(some, coverage[j][..., None], 1), dilated)
    return MipLevel(colours, coverage)


def shrink(one: F32) -> F32:
    """Halve the rows and columns of one slice."""
    height, width = one.shape[:2]
    small = (max(1, width // 2), max(1, height // 2))
    return np.asarray(cv2.resize(one, small, interpolation=cv2.INTER_AREA), np.float32)
