"""Eight bits a coefficient, the way a `.ptm` holds them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]

_DIGITS = 8


class ScaleBias(NamedTuple):
    """value = scale·(code − bias), code 0..255; scale has no more digits than are printed, bias is whole."""

    scale: float
    bias: int

    def decode(self, codes: U8) -> F32:
        """Turn codes into values."""
        values: F32 = np.float32(self.scale) * (codes.astype(np.float32) - np.float32(self.bias))
        return values

    def encode(self, values: NDArray[np.floating]) -> U8:
        """Round values to codes.

        Raises
        ------
        InputError
            A value lies outside what the codes can hold, or is not a number.
        """
        codes = np.rint(np.asarray(values, np.float64) / self.scale + self.bias)
        if not np.all((codes >= 0) & (codes <= 255)):
            raise InputError("coefficients exceed the codes 0..255; take scale and bias from these very coefficients")
        return codes.astype(np.uint8)


def scale_bias(lowest: float, highest: float) -> ScaleBias:
    """Choose scale and bias for values between two bounds.

    The range is extended to hold 0, so that the bias is a code: 0 ≤ bias ≤ 255, which readers rely on. The scale is
    rounded to what will be printed, and leaves one code of room for that and for the rounding of the bias. Where all
    values are 0, scale is 1 and bias 0.
    """
    low, high = min(lowest, 0.0), max(highest, 0.0)
    if not (np.isfinite(low) and np.isfinite(high)):
        raise InputError("a coefficient is not a finite number; fit again")
    scale = float(f"{(high - low) / 254:.{_DIGITS}g}")
    # Below the smallest float32 there is nothing that a reader could tell from 0.
    if scale < np.finfo(np.float32).tiny:
        return ScaleBias(1.0, 0)
    return ScaleBias(scale, round(-low / scale))
