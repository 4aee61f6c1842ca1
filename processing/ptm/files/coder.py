"""From a material to bytes: how it is rounded is chosen once, from a sample, and codes are made strip by strip."""

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.ptm.basis import PTM
from processing.ptm.files.balance import Balance, choose_balance
from processing.ptm.files.quantise import ScaleBias
from processing.ptm.files.rounding import Rounding, choose_rounding
from processing.ptm.model import Material, Strip

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Result = TypeVar("Result")

_SAMPLES = 12_000
# Few enough that what is made of them stays in the processor's nearer memory.
_STRIP_PIXELS = 1 << 14
_AT_ONCE = min(4, os.cpu_count() or 1)


class Codes(NamedTuple):
    """`coefficients` (T, ..., C) uint8, and `colour` (..., 3) uint8 or None; row 0 on top."""

    coefficients: U8
    colour: U8 | None


@dataclass(frozen=True)
class Coder:
    """What turns a material into codes.

    Attributes
    ----------
    roundings : one for all channels, or one for each
    balance : how brightness is shared between luminance and colour, where they are apart
    seen : what of a strip the format can hold
    """

    roundings: tuple[Rounding, ...]
    balance: Balance | None
    seen: Callable[[Strip], Strip]

    @property
    def steps(self) -> tuple[tuple[ScaleBias, ...], ...]:
        """What a code stands for, for each term and in it for each rounding, in units where 1 is white."""
        return tuple(zip(*(rounding.steps for rounding in self.roundings), strict=True))

    def encode(self, strip: Strip) -> Codes:
        """Turn some rows of the material into codes."""
        strip = self.seen(strip)
        if self.balance is not None:
            luminance, colour = self.balance.encode(strip)
            return Codes(luminance[..., None], colour)
        if len(self.roundings) == 1:
            return Codes(self.roundings[0].encode(strip.coefficients), None)
        channels = [
            rounding.encode(strip.coefficients[..., channel]) for channel, rounding in enumerate(self.roundings)
        ]
        return Codes(np.stack(channels, axis=-1), None)

    def stored(self, strip: Strip) -> Strip:
        """Return what a reader of the codes gets of some rows, in the material's own terms."""
        kept = self._decode(self.encode(strip))
        return kept._replace(coefficients=kept.coefficients[-len(strip.coefficients) :])

    def _decode(self, codes: Codes) -> Strip:
        if self.balance is not None and codes.colour is not None:
            return self.balance.decode(codes.coefficients[..., 0], codes.colour)
        if len(self.roundings) == 1:
            return Strip(self.roundings[0].decode(codes.coefficients), None)
        channels = [
            rounding.decode(codes.coefficients[..., channel]) for channel, rounding in enumerate(self.roundings)
        ]
        return Strip(np.stack(channels, axis=-1), None)


def as_it_is(strip: Strip) -> Strip:
    """Keep luminance and colour apart, and as many terms as there are."""
    return strip


def multiplied_out(strip: Strip) -> Strip:
    """Give each channel its own coefficients."""
    return strip if strip.colour is None else Strip(strip.coefficients * strip.colour, None)


def six_terms(strip: Strip) -> Strip:
    """Fill up a polynomial of first degree with zeros."""
    lacking = PTM.terms - len(strip.coefficients)
    missing = np.zeros((lacking, *strip.coefficients.shape[1:]), np.float32)
    return strip._replace(coefficients=np.concatenate([missing, strip.coefficients])) if lacking else strip


def coder_for(
    path: Path, material: Material, *, seen: Callable[[Strip], Strip] = as_it_is, same_for_channels: bool = False
) -> Coder:
    """Choose the steps with which a material loses least.

    Parameters
    ----------
    path : names the file in errors
    seen : what of a strip the format can hold
    same_for_channels : one step a term, as some formats want it

    Raises
    ------
    InputError
        A coefficient or a colour is not finite, or a colour is below 0.
    """
    sample = seen(checked(path, material.sample(_SAMPLES)))
    terms = len(sample.coefficients)
    gram = material.gram if terms == material.basis.terms else PTM.gram
    if sample.colour is not None:
        balance = choose_balance(sample, gram)
        return Coder((balance.rounding,), balance, seen)
    sets = [sample.coefficients] if same_for_channels else np.moveaxis(sample.coefficients, -1, 0)
    return Coder(tuple(choose_rounding(one.reshape(terms, -1), gram) for one in sets), None, seen)


def strips_of(material: Material) -> Iterator[slice]:
    """Go through a material from the top, in strips that fit memory easily."""
    height, width = material.shape
    rows = max(1, _STRIP_PIXELS // width)
    for top in range(0, height, rows):
        yield slice(top, min(top + rows, height))


def worked_out(material: Material, work: Callable[[slice], Result]) -> Iterator[tuple[slice, Result]]:
    """Do something with every strip of a material, a few at a time; yields rows and result from the top."""
    with ThreadPoolExecutor(_AT_ONCE) as workers:
        coming: deque[tuple[slice, Future[Result]]] = deque()
        for rows in strips_of(material):
            coming.append((rows, workers.submit(work, rows)))
            if len(coming) > 2 * _AT_ONCE:
                first, result = coming.popleft()
                yield first, result.result()
        for rows, result in coming:
            yield rows, result.result()


def checked(path: Path, strip: Strip) -> Strip:
    """Return a strip whose values can be written.

    Raises
    ------
    InputError
        One is not finite, or a colour is below 0.
    """
    if not np.isfinite(np.sum(strip.coefficients)):
        raise InputError(f"{path}: coefficients that are not numbers cannot be written; fit again")
    if strip.colour is not None and not (np.isfinite(np.sum(strip.colour)) and strip.colour.min() >= 0):
        raise InputError(f"{path}: colours below 0, or that are not numbers, cannot be written; fit again")
    return strip
