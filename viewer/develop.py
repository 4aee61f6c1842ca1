"""From the light that was drawn to the light that is shown: exposure and tone curve, neither unless asked for."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.radiometry import LUMINANCE

Floats = NDArray[np.floating]
_MOST_STOPS = 30.0


class Tone(StrEnum):
    """How light beyond what a display has is brought into its range."""

    NONE = "none"
    """Not at all: what is above 1 is cut off where the file cannot hold it."""
    REINHARD = "reinhard"
    """c/(1 + Y), Y the luminance (Reinhard and others, Photographic Tone Reproduction, 2002, equation 3)."""
    FILMIC = "filmic"
    """The rational fit of the ACES reference curve by Narkowicz (2015), for each channel; white from about 6 up."""


@dataclass(frozen=True)
class Development:
    """What is made of linear light before it is shown.

    Attributes
    ----------
    exposure_ev : light is multiplied by 2 to this power
    tone : then goes through this curve
    """

    exposure_ev: float = 0.0
    tone: Tone = Tone.NONE

    def __post_init__(self) -> None:
        if not (math.isfinite(self.exposure_ev) and abs(self.exposure_ev) <= _MOST_STOPS):
            raise InputError(f"exposure: {self.exposure_ev:g} stops are outside ±{_MOST_STOPS:g}")

    @property
    def changes_nothing(self) -> bool:
        return self.exposure_ev == 0 and self.tone is Tone.NONE

    def apply(self, picture: Floats) -> Floats:
        """Develop linear light (..., 3), or (..., 4) with coverage, which stays; none is ever below 0 after a curve."""
        if self.changes_nothing:
            return picture
        light: Floats = picture[..., :3] * picture.dtype.type(2.0**self.exposure_ev)
        if self.tone is Tone.REINHARD:
            light = np.maximum(light, 0)
            light = light / (1 + light @ LUMINANCE.astype(picture.dtype))[..., None]
        elif self.tone is Tone.FILMIC:
            light = _filmic(np.maximum(light, 0))
        return np.concatenate([light, picture[..., 3:]], axis=-1)


def _filmic(light: Floats) -> Floats:
    # Beyond this the fit has long reached white, and its squares would overflow.
    bounded = np.minimum(light, light.dtype.type(1e6))
    curve: Floats = (bounded * (2.51 * bounded + 0.03)) / (bounded * (2.43 * bounded + 0.59) + 0.14)
    return np.minimum(curve, 1)
