"""Every way of drawing gives the picture that is kept of it.

A rasteriser of another version may round a little otherwise and choose other levels by a hair: hence the tolerance.
After a change that is meant, `python -m tests.viewer.golden_pictures` draws them again; look before you keep them.
"""

import numpy as np
import pytest

from litrig.base.pictures import read_codes
from tests.viewer.golden_pictures import FOLDER, PICTURES, drawn_codes
from viewer.renderer import Renderer

MEAN, MOST = 1.0, 8
"""Of the difference in codes of 255: on average, and for 99 of 100 pixels."""
LOOK_ALIKE = {"amc-low-rank", "amc-split"}
"""Other ways to the picture of the same table."""


@pytest.mark.parametrize("name", PICTURES)
def test_it_is_the_picture_that_is_kept(renderer: Renderer, name: str) -> None:
    kept = read_codes(FOLDER / f"{name}.png").astype(int)
    apart = np.abs(drawn_codes(renderer, name).astype(int) - kept)
    assert apart.mean() <= MEAN
    assert np.quantile(apart.max(axis=-1), 0.99) <= MOST


def test_no_two_pictures_would_pass_for_each_other() -> None:
    """Otherwise the tolerance is too wide to tell the ways of drawing apart."""
    kept = {name: read_codes(FOLDER / f"{name}.png").astype(int) for name in PICTURES if name not in LOOK_ALIKE}
    names = sorted(kept)
    for index, first in enumerate(names):
        for second in names[index + 1 :]:
            if kept[first].shape != kept[second].shape:
                continue
            apart = np.abs(kept[first] - kept[second])
            assert apart.mean() > MEAN or np.quantile(apart.max(axis=-1), 0.99) > MOST, (first, second)


def test_a_kept_picture_is_small_and_belongs_to_something() -> None:
    files = sorted(FOLDER.glob("*"))
    assert {file.stem for file in files} == set(PICTURES)
    assert all(file.stat().st_size <= 20_000 for file in files)
