"""The chain of blurred maps that roughness is read from."""

import numpy as np
import pytest

from processing.paraboloid.blur import blurred
from processing.paraboloid.chain import blur_chain, level_of, variance_of
from processing.paraboloid.maps import texel_directions

SIZE = 48
LAMP = [np.exp(40 * (d @ [0.6, 0.0, 0.8] - 1))[..., None] * np.ones(3, np.float32) for d in texel_directions(SIZE)]


def test_each_level_is_blurred_by_its_variance() -> None:
    levels = blur_chain(LAMP[0].astype(np.float32), LAMP[1].astype(np.float32), 0.4)
    assert variance_of(len(levels) - 1, SIZE) < 0.4 <= variance_of(len(levels), SIZE)
    for number, level in enumerate(levels, start=1):
        wanted = np.stack(blurred(LAMP[0], LAMP[1], variance_of(number, SIZE)))
        assert np.abs(level - wanted).max() < 0.02 * wanted.max()


def test_variances_are_found_among_the_levels() -> None:
    for level in (1, 2, 5):
        assert level_of(np.array(variance_of(level, SIZE)), SIZE) == pytest.approx(level)
    assert level_of(np.array([0.0, variance_of(1, SIZE) / 4]), SIZE).tolist() == pytest.approx([0, 0.25])
