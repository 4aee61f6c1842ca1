"""The block that a texture asks for grows with its features."""

from dataclasses import replace

import numpy as np
import pytest

from processing.ptm.synthesis.settings import Synthesis
from processing.ptm.synthesis.suggestion import default_overlap, suggest
from tests.processing.ptm.synthesis.textures import flat, rough


def test_coarser_textures_get_larger_blocks() -> None:
    blocks = [suggest([rough(160, blur_px=blur)], ["x"], Synthesis()).block_px for blur in (1.5, 3.0, 5.0)]
    assert blocks == sorted(set(blocks))
    assert blocks[-1] <= 40


@pytest.mark.parametrize("period", [10, 17])
def test_a_block_holds_more_than_a_period(period: int) -> None:
    source = rough(120)
    wave = 0.4 * np.sin(2 * np.pi * np.arange(120) / period)
    coefficients = source.coefficients.copy()
    coefficients[5] += wave[:, None].astype(np.float32)
    found = suggest([replace(source, coefficients=coefficients)], ["x"], Synthesis())
    assert abs(found.period_px - period) <= 1
    assert found.block_px > period


def test_a_flat_material_gets_the_smallest() -> None:
    assert suggest([flat(80)], ["x"], Synthesis()).block_px == 12


def test_a_block_is_never_larger_than_what_fits() -> None:
    assert suggest([rough(17, blur_px=4)], ["x"], Synthesis()).block_px <= 17


def test_the_overlap_is_a_fifth() -> None:
    assert [default_overlap(block) for block in (4, 12, 30, 60)] == [1, 2, 6, 12]
