"""A polynomial texture map in memory."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Space = Literal["srgb", "linear"]


@dataclass(frozen=True)
class Ptm:
    """Six coefficients a pixel, so that any light direction gives a picture (Texture paper, equation 8).

    Attributes
    ----------
    coefficients : (6, H, W, C) float32, order u², v², uv, u, v, 1, in units where 1 is white; row 0 on top.
        C = 3 in an RGB PTM. C = 1 in an LRGB PTM, where the polynomial is luminance alone
    colour : (H, W, 3) float32, the factor of the luminance in an LRGB PTM; None in an RGB PTM
    space : "srgb" if the fitted values were display-encoded (the field's habit), "linear" if they were light
    source : digest of the frames that it was fitted to
    """

    coefficients: NDArray[np.float32]
    colour: NDArray[np.float32] | None
    space: Space = "srgb"
    source: str = ""
