"""Eight bits a coefficient: steps that are chosen once for a whole material, and codes that are made strip by strip.

Of a material of luminance and colour only the product counts. With all brightness in the luminance, one bright pixel
sets the step for all; with all of it in the colour, dark pixels have few codes for it. In between, luminance is divided
by amplitude^p and colour multiplied by it, and the p with the least error over a sample of pixels is taken.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.files.quantise import ScaleBias, scale_bias
from processing.ptm.model import Material, Strip

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

_POWERS = (0.0, 0.25, 0.5, 0.75, 1.0)
_SAMPLES = 40_000
_FAINTEST, _DARKEST = 1e-3, 1e-30
_STRIP_PIXELS = 1 << 18


class Codes(NamedTuple):
    """`coefficients` (T, h, W, C) uint8, and `colour` (h, W, 3) uint8 or None; row 0 on top."""

    coefficients: U8
    colour: U8 | None


@dataclass(frozen=True)
class Coder:
    """What turns a material into bytes.

    Attributes
    ----------
    steps : for each term, and in it for each channel, what a code stands for, in units where 1 is white
    power, brightest, largest : how brightness is shared between luminance and colour
    """

    steps: tuple[tuple[ScaleBias, ...], ...]
    power: float = 0.0
    brightest: float = 1.0
    largest: float = 1.0

    def encode(self, strip: Strip) -> Codes:
        """Turn some rows into codes."""
        coefficients, colour = _shared(strip, self.power, self.brightest)
        if colour is not None:
            coefficients, colour = coefficients * self.largest, colour / self.largest
        codes = np.zeros(coefficients.shape, np.uint8)
        for term, steps in enumerate(self.steps):
            for channel, step in enumerate(steps):
                codes[term, ..., channel] = step.encode(coefficients[term, ..., channel])
        return Codes(codes, None if colour is None else np.rint(np.clip(colour, 0, 1) * 255).astype(np.uint8))


def coder_for(path: Path, material: Material, *, same_for_channels: bool = False) -> Coder:
    """Choose the steps by which all of a material can be written.

    Parameters
    ----------
    path : names the file in errors
    same_for_channels : one step a term, as some formats want it

    Raises
    ------
    InputError
        A coefficient or a colour is not finite, or a colour is below 0.
    """
    power, brightest = (0.0, 1.0) if material.kind == "rgb" else _sharing(path, material)
    shape = (material.basis.terms, 3 if material.kind == "rgb" else 1)
    low, high = np.zeros(shape), np.zeros(shape)
    largest = 0.0
    for rows in strips_of(material):
        coefficients, colour = _shared(_checked(path, material.strip(rows)), power, brightest)
        low = np.minimum(low, coefficients.min(axis=(1, 2)))
        high = np.maximum(high, coefficients.max(axis=(1, 2)))
        if colour is not None:
            largest = max(largest, float(colour.max()))
    largest = 1.0 if material.kind == "rgb" else max(largest, _DARKEST)
    if same_for_channels:
        low[:], high[:] = low.min(axis=1, keepdims=True), high.max(axis=1, keepdims=True)
    steps = tuple(
        tuple(scale_bias(float(a), float(b)) for a, b in zip(lows, highs, strict=True))
        for lows, highs in zip(low * largest, high * largest, strict=True)
    )
    return Coder(steps, power, brightest, largest)


def strips_of(material: Material) -> Iterator[slice]:
    """Go through a material from the top, in strips that fit memory easily."""
    height, width = material.shape
    rows = max(1, _STRIP_PIXELS // width)
    for top in range(0, height, rows):
        yield slice(top, min(top + rows, height))


def _checked(path: Path, strip: Strip) -> Strip:
    if not np.all(np.isfinite(strip.coefficients)):
        raise InputError(f"{path}: coefficients that are not numbers cannot be written; fit again")
    if strip.colour is not None and not np.all((strip.colour >= 0) & np.isfinite(strip.colour)):
        raise InputError(f"{path}: colours below 0, or that are not numbers, cannot be written; fit again")
    return strip


def _shared(strip: Strip, power: float, brightest: float) -> tuple[F32, F32 | None]:
    """Move brightness from luminance to colour."""
    if strip.colour is None:
        return strip.coefficients, None
    amplitude = np.abs(strip.coefficients[..., 0]).max(axis=0)
    factor = np.maximum(amplitude / np.float32(brightest), np.float32(_FAINTEST)) ** np.float32(power)
    return strip.coefficients / factor[..., None], strip.colour * factor[..., None]


def _sharing(path: Path, material: Material) -> tuple[float, float]:
    """Return the power with the least error over a sample, and the brightest amplitude in it."""
    height, width = material.shape
    strip = _checked(path, material.sample(min(_SAMPLES, height * width)))
    brightest = max(float(np.abs(strip.coefficients).max()), _DARKEST)
    errors = [_squared_error(strip, material.basis.gram, power, brightest) for power in _POWERS]
    return _POWERS[int(np.argmin(errors))], brightest


def _squared_error(strip: Strip, gram: F64, power: float, brightest: float) -> float:
    """Mean squared error over lights, pixels and channels after both went through eight bits."""
    luminance, colour = _shared(strip, power, brightest)
    if strip.colour is None or colour is None:
        return 0.0
    largest = max(float(colour.max()), _DARKEST)
    stored = np.stack([_through(term[0, :, 0] * largest) for term in luminance])
    codes = np.rint(colour[0] / largest * 255) / 255
    lost = stored[:, :, None] * codes - strip.coefficients[:, 0] * strip.colour[0]
    return float(np.einsum("tpc,ts,spc->", lost, gram, lost))


def _through(term: F32) -> F64:
    step = scale_bias(float(term.min()), float(term.max()))
    return np.asarray(step.scale * (np.rint(term / step.scale + step.bias) - step.bias), np.float64)
