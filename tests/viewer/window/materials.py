"""Materials that are seen in the window, and what a picture of them should be."""

import numpy as np
from numpy.typing import NDArray

from litrig.base.radiometry import decode_srgb
from processing.ptm.model import Ptm
from processing.reference.display import display_codes, over
from viewer.staging import DARK_GREY

Codes = NDArray[np.uint8]
DISPLAY_STEPS = 2
"""Two drivers, or a driver and NumPy, agree within so many codes of 255."""


def soft_ptm(width: int, height: int) -> Ptm:
    """A PTM that changes slowly from texel to texel, and much with the light."""
    x, y = np.meshgrid(np.linspace(-1, 1, width), np.linspace(1, -1, height))
    terms = [-0.2 + 0.1 * x, -0.2 + 0.1 * y, 0.1 * x * y, 0.35 * x, 0.35 * y, 0.5 + 0.1 * x]
    colour = np.stack([0.9 + 0.1 * x, 0.8 - 0.1 * y, 0.6 + 0.2 * x * y], axis=-1)
    return Ptm(np.stack(terms)[..., None].astype(np.float32), colour.astype(np.float32))


def shown_codes(picture: NDArray[np.float32]) -> Codes:
    """Lay a rendered picture (H, W, 4) over the window's background, in NumPy; (H, W, 3) display codes."""
    red, green, blue = (float(part) for part in decode_srgb(np.array(DARK_GREY)))
    codes: Codes = display_codes(over(picture, (red, green, blue)))[..., :3]
    return codes


def steps_apart(first: Codes, second: Codes) -> float:
    """The 99.9th percentile of the difference."""
    assert first.shape == second.shape
    return float(np.quantile(np.abs(first.astype(int) - second).max(axis=-1), 0.999))
