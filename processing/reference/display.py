"""From a rendered picture to the numbers of an image file."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import U8, encode_srgb, to_u8

Picture = NDArray[np.floating]


def display_codes(picture: Picture) -> U8:
    """Encode linear light and coverage (H, W, 4) as sRGB codes (H, W, 4) with linear alpha."""
    return to_u8(np.concatenate([encode_srgb(picture[..., :3]), picture[..., 3:]], axis=-1))


def over(picture: Picture, background: tuple[float, float, float]) -> Picture:
    """Lay a picture (H, W, 4), straight alpha, over a plain linear background; the result covers everything."""
    coverage = picture[..., 3:]
    colours = np.asarray(background, picture.dtype) * (1 - coverage) + picture[..., :3] * coverage
    return np.concatenate([colours, np.ones_like(coverage)], axis=-1)
