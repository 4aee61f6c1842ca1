"""Luminance and colour of an LRGB material in eight bits each.

Only their product counts. With all brightness in the luminance, one bright pixel sets the step for all; with all of it
in the colour, dark pixels have few codes for it. In between, the colour takes amplitude^p of each pixel's brightness,
and the p with the least error is taken. The colour is rounded first, and the luminance is then the best one for it.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from processing.ptm.files.rounding import Rounding, choose_rounding, make_rounding
from processing.ptm.model import Strip

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

_POWERS = (0.0, 0.25, 0.5, 0.75, 1.0)
_FAINTEST = 1e-3


@dataclass(frozen=True)
class Balance:
    """How brightness is shared, and how both shares are rounded.

    Attributes
    ----------
    power : the exponent p
    scale : what colours are multiplied by, so that the brightest reaches the last code
    rounding : of the luminance
    """

    power: float
    scale: float
    rounding: Rounding

    def encode(self, strip: Strip) -> tuple[U8, U8]:
        """Round luminance (T, h, W, 1) and colour (h, W, 3) to codes (T, h, W) and (h, W, 3)."""
        assert strip.colour is not None  # noqa: S101  # for the type checker: LRGB it is
        codes = _colour_codes(strip.coefficients[..., 0], strip.colour, self.power, self.scale)
        return self.rounding.encode(_best_luminance(strip.coefficients[..., 0], strip.colour, codes)), codes

    def decode(self, luminance: U8, colour: U8) -> Strip:
        """Turn codes into what a reader of the file gets."""
        return Strip(self.rounding.decode(luminance)[..., None], colour.astype(np.float32) / np.float32(255))


def choose_balance(sample: Strip, gram: F64) -> Balance:
    """Choose the exponent and the steps with which a sample loses least in the mean over lights.

    Parameters
    ----------
    sample : luminance and colour of some pixels
    gram : (T, T) mean of the products of the terms over lights
    """
    assert sample.colour is not None  # noqa: S101  # for the type checker: LRGB it is
    luminance, colour = sample.coefficients[..., 0], sample.colour
    tried = [_try(sample, colour, gram, power) for power in _POWERS]
    _, power, scale, best, weights = min(tried, key=lambda one: one.loss)
    return Balance(power, scale, choose_rounding(best.reshape(len(luminance), -1), gram, weights))


class _Tried(NamedTuple):
    loss: float
    power: float
    scale: float
    luminance: F32
    weights: F32


def _try(sample: Strip, colour: F32, gram: F64, power: float) -> _Tried:
    """See what a sample loses with steps that hold all of its luminance."""
    luminance = sample.coefficients[..., 0]
    scale = 255 / max(float((colour * _factor(luminance, power)[..., None]).max()), 1e-30)
    codes = _colour_codes(luminance, colour, power, scale)
    best = _best_luminance(luminance, colour, codes)
    bounds = [(float(term.min()), float(term.max())) for term in best]
    balance = Balance(power, scale, make_rounding(bounds, gram))
    stored = balance.decode(*balance.encode(sample))
    lost = (stored.coefficients * (stored.colour if stored.colour is not None else 1)) - sample.coefficients * colour
    flat = lost.reshape(len(lost), -1).astype(np.float64)
    weights = np.sum((codes.reshape(-1, 3) / np.float32(255)) ** 2, axis=-1)
    return _Tried(float(np.sum(flat * (gram @ flat))), power, scale, best, weights)


def _factor(luminance: F32, power: float) -> F32:
    """Return amplitude^p of each pixel; what is all but black counts as a little brighter."""
    if power == 0:
        return np.ones(luminance.shape[1:], np.float32)
    amplitude = np.maximum(np.abs(luminance).max(axis=0), np.float32(_FAINTEST))
    factor: F32 = amplitude if power == 1 else amplitude ** np.float32(power)
    return factor


def _colour_codes(luminance: F32, colour: F32, power: float, scale: float) -> U8:
    shared = colour * (np.float32(scale) * _factor(luminance, power))[..., None]
    return np.minimum(shared + np.float32(0.5), np.float32(255)).astype(np.uint8)


def _best_luminance(luminance: F32, colour: F32, codes: U8) -> F32:
    """Return the luminance that with a rounded colour comes nearest to what luminance and colour were together."""
    rounded = codes.astype(np.float32) / np.float32(255)
    square = np.einsum("...c,...c->...", rounded, rounded)
    share = np.einsum("...c,...c->...", colour, rounded) / np.where(square > 0, square, 1)
    best: F32 = luminance * share
    return best
