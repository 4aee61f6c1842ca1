"""Sharing brightness between luminance and colour of an LRGB PTM so that eight bits of both lose least.

Only their product counts. With all brightness in the luminance, one bright pixel sets the step for all; with all of it
in the colour, dark pixels have few codes for it. In between, luminance is divided by amplitude^p and colour multiplied
by it, and the p with the least error is taken.
"""

import numpy as np
from numpy.typing import NDArray

from processing.ptm.basis import PTM
from processing.ptm.files.quantise import ScaleBias, scale_bias

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

_POWERS = (0.0, 0.25, 0.5, 0.75, 1.0)
_SAMPLES = 40_000
_FAINTEST = 1e-3


def balance(luminance: F32, colour: F32) -> tuple[F32, F32]:
    """Choose the split.

    Parameters
    ----------
    luminance : (6, H, W, 1), and colour : (H, W, 3), of any split

    Returns
    -------
    luminance, colour : the same product, colour in 0..1 with 1 reached
    """
    stride = max(1, luminance[0].size // _SAMPLES)
    some_luminance = luminance.reshape(PTM.terms, -1)[:, ::stride].astype(np.float64)
    some_colour = colour.reshape(-1, 3)[::stride].astype(np.float64)
    errors = [_squared_error(some_luminance, some_colour, power) for power in _POWERS]
    factor, largest = _factor(luminance[..., 0], colour, _POWERS[int(np.argmin(errors))])
    shared = (colour * factor[..., None]).astype(np.float32)
    return (luminance / factor[..., None] * largest).astype(np.float32), np.minimum(shared / largest, 1)


def _squared_error(luminance: F64, colour: F64, power: float) -> float:
    """Mean squared error over lights, pixels and channels after both went through eight bits."""
    factor, largest = _factor(luminance, colour, power)
    scaled, shared = luminance / factor * largest, colour * factor[..., None] / largest
    steps = [scale_bias(float(term.min()), float(term.max())) for term in scaled]
    stored = np.stack([_through(step, term) for step, term in zip(steps, scaled, strict=True)])
    codes = np.rint(shared * 255) / 255
    lost = stored[:, :, None] * codes - luminance[:, :, None] * colour
    return float(np.einsum("tpc,ts,spc->", lost, PTM.gram, lost))


def _through(step: ScaleBias, term: F64) -> F64:
    return step.scale * (np.rint(term / step.scale + step.bias) - step.bias)


def _factor(luminance: NDArray[np.floating], colour: NDArray[np.floating], power: float) -> tuple[F64, float]:
    """Return by what each pixel's luminance is divided, and the largest colour that this gives."""
    amplitude = np.abs(luminance).max(axis=0).astype(np.float64)
    brightest = max(float(amplitude.max()), 1e-30)
    factor = np.maximum(amplitude / brightest, _FAINTEST) ** power
    return factor, max(float((colour * factor[..., None]).max()), 1e-30)
