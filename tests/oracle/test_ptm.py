"""A PTM of a rendered relief, through the file and back, is as good as floats allow."""

from pathlib import Path

import pytest

from processing.ptm.model import Colour
from tests.oracle.measure import ptm_fit
from tests.oracle.shoot import RELIEF, Studio

MOST_LOSS_DB = 0.1


@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
def test_the_file_loses_no_tenth_of_a_decibel_against_float_least_squares(
    studio: Studio, tmp_path: Path, colour: Colour
) -> None:
    result = ptm_fit(studio, RELIEF, tmp_path / "relief.ptm", colour)
    assert result.ours_db > result.lstsq_db - MOST_LOSS_DB
    assert result.lstsq_db > 20, "the frames fit no polynomial at all; is the light where the list says?"
