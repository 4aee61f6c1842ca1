"""One picture of several files: brackets and averages put together, darkness taken off, divided by a white card.

All in linear light. What a pixel got in its exposures together is divided by how long they were together, clipped ones
left out: with photon noise that is the best estimate there is. Of the dark frames comes off what the lamps did not add,
ambient light and the sensor's own level; the white card shows how unevenly, and in which colour, the lamps shine.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from litrig.base.capture_folder.capture import Capture, CapturedFrame, Exposure, Role
from litrig.base.errors import FormatError
from litrig.base.pictures import read_linear

F32 = NDArray[np.float32]

CLIPPED = 0.95
"""Linear light from which on a pixel counts as clipped: display value 250 of 255."""
CARD_WIDTH_PX = 256
"""A white card is kept so small: the light on it changes slowly, and its grain is none of the lamps'."""
DARKEST_WHITE = 0.05
"""Where the card is darker than this share of its median, it is no card: the light is left as it is there."""


class References:
    """Dark and white frames of a session.

    Parameters
    ----------
    dark, white : the frames, of which there may be none
    """

    def __init__(self, dark: Sequence[CapturedFrame], white: Sequence[CapturedFrame]) -> None:
        self._dark = [exposure for frame in dark for exposure in _exposures(frame)]
        self._white = list(white)

    def __bool__(self) -> bool:
        return bool(self._dark or self._white)

    def darkness(self, exposure_ev: float) -> F32 | float:
        """Return what an exposure holds without the lamps, (H, W, 3), or 0."""
        if not self._dark:
            return 0.0
        nearest = min((exposure.exposure_ev for exposure in self._dark), key=lambda ev: abs(ev - exposure_ev))
        if nearest not in self._darkness:
            paths = [exposure.path for exposure in self._dark if exposure.exposure_ev == nearest]
            total = np.asarray(read_linear(paths[0]), np.float32)
            for path in paths[1:]:
                total = total + _of_size(path, total.shape)
            self._darkness[nearest] = total / np.float32(len(paths))
        return np.asarray(self._darkness[nearest] * np.float32(2.0 ** (exposure_ev - nearest)), np.float32)

    def gain(self, light: NDArray[np.float64] | None, shape: tuple[int, ...]) -> F32 | float:
        """Return by what a picture of some shape under a light is to be multiplied, (H, W, 3), or 1."""
        if not self._white:
            return 1.0
        place = 0
        if light is not None:
            nearness = [-1.0 if frame.light is None else float(frame.light @ light) for frame in self._white]
            place = int(np.argmax(nearness))
        card = self._cards[place]
        is_card = card > DARKEST_WHITE * np.median(card)
        gain = np.where(is_card, self._level / np.maximum(card, 1e-6), np.float32(1)).astype(np.float32)
        return np.asarray(cv2.resize(gain, (shape[1], shape[0]), interpolation=cv2.INTER_LINEAR), np.float32)

    @cached_property
    def _darkness(self) -> dict[float, F32]:
        return {}

    @cached_property
    def _cards(self) -> list[F32]:
        return [_shrunk(put_together(_exposures(frame), self)) for frame in self._white]

    @cached_property
    def _level(self) -> np.float32:
        """The light of the card in the mean of all its pictures: so lamps become equally bright, and neutral."""
        return np.float32(np.mean([np.median(card) for card in self._cards]))


NO_REFERENCES = References((), ())


@dataclass(frozen=True)
class Composite:
    """A picture that several files make.

    Attributes
    ----------
    path : what names it in messages
    exposures : the files
    light : (3,) under which it was shot, if it is known
    references : what comes off and divides it
    """

    path: Path
    exposures: tuple[Exposure, ...]
    light: NDArray[np.float64] | None = None
    references: References = NO_REFERENCES

    def linear(self) -> F32:
        """Put it together: linear light (H, W, 3), 1 is white at the usual exposure; more than 1 where brackets tell.

        Raises
        ------
        InputError, FormatError
            A file is missing, damaged, or of another size than the others.
        """
        light = put_together(self.exposures, self.references)
        return np.asarray(light * self.references.gain(self.light, light.shape), np.float32)


def pictures_of(capture: Capture, frames: Sequence[CapturedFrame]) -> list[Path | Composite]:
    """Return the pictures of some frames of a session: files as they are, where nothing is to be done to them."""
    references = References(list(capture.having(Role.DARK)), list(capture.having(Role.WHITE)))
    return [
        Composite(frame.path, _exposures(frame), frame.light, references)
        if references or frame.exposures
        else frame.path
        for frame in frames
    ]


def put_together(exposures: Sequence[Exposure], references: References) -> F32:
    """Make one picture (H, W, 3) of exposures: light over time, clipped pixels left out; less the darkness."""
    shortest = min(exposures, key=lambda exposure: exposure.exposure_ev)
    light = times = fallback = None
    for exposure in exposures:
        stored = read_linear(exposure.path) if light is None else _of_size(exposure.path, light.shape)
        darkness = references.darkness(exposure.exposure_ev)
        if isinstance(darkness, np.ndarray) and darkness.shape != stored.shape:
            raise FormatError(f"{exposure.path}: is of another size than the dark frames; shoot one of them again")
        added = np.maximum(stored - darkness, 0).astype(np.float32)
        counts = (stored.max(axis=-1, keepdims=True) < CLIPPED).astype(np.float32)
        time = np.float32(2.0**exposure.exposure_ev)
        if exposure is shortest:
            fallback = added / time
        light = added * counts if light is None else light + added * counts
        times = time * counts if times is None else times + time * counts
    assert light is not None and times is not None and fallback is not None  # noqa: S101  # there is one at least
    return np.asarray(np.where(times > 0, light / np.maximum(times, 1e-6), fallback), np.float32)


def _shrunk(card: F32) -> F32:
    size = (CARD_WIDTH_PX, max(1, round(CARD_WIDTH_PX * card.shape[0] / card.shape[1])))
    small = cv2.resize(card, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.GaussianBlur(small, (0, 0), 2.0), np.float32)


def _exposures(frame: CapturedFrame) -> tuple[Exposure, ...]:
    return frame.exposures or (Exposure(frame.path),)


def _of_size(path: Path, shape: tuple[int, ...]) -> F32:
    picture = read_linear(path)
    if picture.shape != shape:
        raise FormatError(
            f"{path}: is {picture.shape[1]} × {picture.shape[0]} pixels, those that it belongs to are "
            f"{shape[1]} × {shape[0]}; shoot it again at that size, or take it out"
        )
    return picture
