"""Smaller copies of a low-rank AMC that multiply out to the smaller copies of its table.

Averaging over texels touches the pictures alone, averaging over k the curves alone, so that neither needs the table.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from processing.amc.low_rank import LowRankAmc
from processing.amc.mips import area_weights, level_count, shrink

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class LowRankLevel:
    """One level of the pyramid.

    Attributes
    ----------
    pictures : (rank, S, S, 3) float32, signed
    curves : (D, rank) float32
    """

    pictures: F32
    curves: F32


def low_rank_mip_chain(low_rank: LowRankAmc) -> list[LowRankLevel]:
    """Build all levels, the full one first, weighted by validity as those of a table are."""
    pictures, curves = np.asarray(low_rank.pictures, np.float32), np.asarray(low_rank.curves, np.float32)
    coverage = low_rank.valid.astype(np.float32)
    levels = [LowRankLevel(pictures, curves)]
    for _ in range(level_count(pictures.shape[1], len(curves)) - 1):
        pictures, coverage = _halve(pictures, coverage)
        curves = area_weights(len(curves), max(1, len(curves) // 2)) @ curves
        levels.append(LowRankLevel(pictures, curves))
    return levels


def _halve(pictures: F32, coverage: F32) -> tuple[F32, F32]:
    small = shrink(coverage)
    some = small[..., None] > 0
    share = np.where(some, small[..., None], 1)
    # Where nothing was seen the dilated colours are all there is to average.
    halved = [np.where(some, shrink(one * coverage[..., None]) / share, shrink(one)) for one in pictures]
    return np.stack(halved), small
