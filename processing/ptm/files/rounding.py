"""Coefficients in eight bits, so that the pictures under all lights lose least.

Each coefficient on its own is off by up to half a step. But what a picture loses is a sum over terms, and they are far
from independent: u² and v² are positive everywhere, like 1. So the terms are rounded one after the other, and each
makes up for what those before have lost, in the mean over the lights. Where the steps are chosen, a few extreme pixels
are rather cut off than to have all others pay for them in coarser steps; their terms are gone over once more.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.kernels import kernel
from processing.ptm.files.quantise import ScaleBias, scale_bias

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

_SHARES = (0.0, 1e-4, 1e-3, 4e-3, 1.5e-2)
"""Shares of the pixels that may lie outside a term's codes, at each end."""
_TILE = 1024
_SECOND_LOOKS = 3
_TRIED = 4000
# Beside the square of white, or of bright pixels where they are brighter.
_RUIN = 0.06


@dataclass(frozen=True)
class Rounding:
    """How coefficients become codes.

    Attributes
    ----------
    steps : scale and bias of each term
    order : (T,) the terms, the coarsest first
    makes_up : (T, T) how much of what earlier terms have lost is added to a later one, both in `order`
    settles : (T, T) how much of what all others have lost is added to a term of a pixel that was cut off
    """

    steps: tuple[ScaleBias, ...]
    order: NDArray[np.int64]
    makes_up: F32
    settles: F32

    def encode(self, coefficients: F32) -> U8:
        """Round (T, ...) to codes of the same shape; what the codes cannot hold becomes the nearest one."""
        codes = np.zeros(coefficients.shape, np.uint8)
        scales = np.array([step.scale for step in self.steps], np.float32)
        biases = np.array([step.bias for step in self.steps], np.float32)
        flat = np.ascontiguousarray(coefficients, np.float32).reshape(len(codes), -1)
        _encode(flat, scales, biases, self.order, self.makes_up, self.settles, codes.reshape(len(codes), -1))
        return codes

    def decode(self, codes: U8) -> F32:
        """Turn codes (T, ...) into coefficients."""
        return np.stack([step.decode(term) for step, term in zip(self.steps, codes, strict=True)])


def choose_rounding(sample: F32, gram: F64, weights: F32 | None = None) -> Rounding:
    """Choose steps with which a sample loses least.

    Parameters
    ----------
    sample : (T, n) coefficients
    gram : (T, T) mean of the products of the terms over lights
    weights : (n,) how much a pixel's loss counts; alike if None

    Raises
    ------
    InputError
        A coefficient is not a finite number.
    """
    # A share of less than a pixel is none.
    shares = [share for share in _SHARES if share == 0 or share * sample.shape[1] >= 1]
    bounds = [[_bounds(term, share) for share in shares] for term in sample]
    some = np.ascontiguousarray(sample[:, :: max(1, sample.shape[1] // _TRIED)])
    weighing = np.ones(1) if weights is None else weights[:: max(1, sample.shape[1] // _TRIED)]
    ruin = _RUIN * max(1.0, float(np.quantile(np.sum(some * (gram @ some), axis=0), 0.9)))
    chosen = [0] * len(sample)

    def rounding(picks: Sequence[int]) -> Rounding:
        return make_rounding([bounds[term][pick] for term, pick in enumerate(picks)], gram)

    def loss(picks: Sequence[int]) -> float:
        tried = rounding(picks)
        lost = some - tried.decode(tried.encode(some))
        # A pixel that is ruined is ruined: how far is no reason to coarsen the steps of all others.
        return float(np.sum(np.minimum(np.sum(lost * (gram @ lost), axis=0), ruin) * weighing))

    best = loss(chosen)
    for pick in range(1, len(shares)):  # all terms alike, then each on its own
        together = [pick] * len(sample)
        if (lost := loss(together)) < best:
            best, chosen = lost, together
    for term in range(len(sample)):
        for pick in range(len(shares)):
            other = [*chosen[:term], pick, *chosen[term + 1 :]]
            if pick != chosen[term] and (lost := loss(other)) < best:
                best, chosen = lost, other
    return rounding(chosen)


def make_rounding(bounds: Sequence[tuple[float, float]], gram: F64) -> Rounding:
    """Take steps that hold the bounds of each term, and work out how terms make up for each other."""
    steps = tuple(scale_bias(low, high) for low, high in bounds)
    coarseness = np.array([step.scale for step in steps]) * np.sqrt(np.diag(gram))
    order = np.argsort(-coarseness, kind="stable").astype(np.int64)
    sorted_gram = gram[np.ix_(order, order)]
    makes_up = np.zeros_like(gram)
    for place in range(1, len(order)):
        # With the first terms rounded, these are the best values of the others; one of them is rounded next.
        free = np.linalg.lstsq(sorted_gram[place:, place:], sorted_gram[place:, :place], rcond=None)[0]
        makes_up[place, :place] = free[0]
    settles = sorted_gram / np.diag(sorted_gram)[:, None] * (1 - np.eye(len(order)))
    return Rounding(steps, order, makes_up.astype(np.float32), settles.astype(np.float32))


def _bounds(term: F32, share: float) -> tuple[float, float]:
    low, high = np.quantile(term, [share, 1 - share])
    return float(low), float(high)


@kernel
def _encode(
    coefficients: F32, scales: F32, biases: F32, order: NDArray[np.int64], makes_up: F32, settles: F32, codes: U8
) -> None:
    terms, pixels = coefficients.shape
    lost = np.zeros((terms, _TILE), np.float32)
    wanted, cut = np.zeros(_TILE, np.float32), np.zeros(_TILE, np.uint8)
    for first in range(0, pixels, _TILE):
        stop = min(pixels, first + _TILE)
        cut[:] = 0
        for place in range(terms):
            term = order[place]
            values = coefficients[term, first:stop]
            wanted[: stop - first] = values
            for other in range(place):
                _make_up(makes_up[place, other], lost[other], wanted)
            _round(values, wanted, scales[term], biases[term], codes[term, first:stop], lost[place], cut)
        for pixel in range(stop - first):
            if cut[pixel]:
                _settle(coefficients, scales, biases, order, settles, codes, lost, first, pixel)


@kernel
def _make_up(share: np.float32, lost: F32, wanted: F32) -> None:
    for pixel in range(len(wanted)):
        wanted[pixel] += share * lost[pixel]


@kernel
def _round(values: F32, wanted: F32, scale: np.float32, bias: np.float32, codes: U8, lost: F32, cut: U8) -> None:
    each = np.float32(1) / scale
    for pixel in range(len(values)):
        exact = wanted[pixel] * each + bias
        code = min(max(exact, np.float32(0)), np.float32(255))
        whole = np.uint8(code + np.float32(0.5))
        codes[pixel] = whole
        lost[pixel] = values[pixel] - scale * (np.float32(whole) - bias)
        cut[pixel] |= np.uint8(exact != code)


@kernel
def _settle(
    coefficients: F32,
    scales: F32,
    biases: F32,
    order: NDArray[np.int64],
    settles: F32,
    codes: U8,
    lost: F32,
    first: int,
    pixel: int,
) -> None:
    """Round the terms of one pixel again, each beside what all others have lost."""
    for _ in range(_SECOND_LOOKS):
        for place in range(len(order)):
            term = order[place]
            wanted = coefficients[term, first + pixel]
            for other in range(len(order)):
                wanted += settles[place, other] * lost[other, pixel]
            code = min(max(wanted / scales[term] + biases[term], np.float32(0)), np.float32(255))
            whole = np.uint8(code + np.float32(0.5))
            codes[term, first + pixel] = whole
            lost[place, pixel] = coefficients[term, first + pixel] - scales[term] * (np.float32(whole) - biases[term])
