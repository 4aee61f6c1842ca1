"""Smaller copies of pictures and curves multiply out to the smaller copies of the table."""

import numpy as np
import pytest

from processing.amc.low_rank import compress
from processing.amc.low_rank_mips import low_rank_mip_chain
from processing.amc.mips import mip_chain
from processing.amc.model import Amc


@pytest.mark.parametrize(("size", "depth", "rank"), [(8, 8, 3), (6, 5, 5), (5, 12, 1), (4, 1, 1)])
def test_every_level_multiplies_out_to_that_of_the_table(size: int, depth: int, rank: int) -> None:
    random = np.random.default_rng(3)
    valid = random.random((size, size)) > 0.3
    amc = Amc(random.random((depth, size, size, 3), np.float32), np.repeat(valid[None], depth, axis=0), 1)
    low_rank = compress(amc, rank)
    levels, truth = low_rank_mip_chain(low_rank), mip_chain(low_rank.expand())
    assert len(levels) == len(truth) > 1
    for level, table in zip(levels, truth, strict=True):
        found = np.tensordot(level.curves, level.pictures, axes=1)
        np.testing.assert_allclose(found, table.colours, atol=2e-5)
