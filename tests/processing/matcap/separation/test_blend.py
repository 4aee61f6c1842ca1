from typing import get_args

import numpy as np
import pytest

from litrig.base.errors import InputError
from processing.matcap.separation.blend import Blend, above, blended


@pytest.mark.parametrize("blend", get_args(Blend))
def test_the_layer_above_gives_the_picture_back(blend: Blend) -> None:
    draw = np.random.default_rng(0)
    picture = draw.random((9, 9, 3))
    picture[0] = 1
    low = picture * draw.random((9, 9, 3))
    low[0, :3] = picture[0, :3]
    high = above(picture, low, blend)
    assert high.min() >= 0 and high.max() <= 1
    np.testing.assert_allclose(blended(low, high, blend), picture, atol=1e-15)


def test_what_is_brighter_than_white_cannot_be_screened() -> None:
    with pytest.raises(InputError, match="ends at 1"):
        above(np.array([2.0]), np.array([0.5]), "screen")
