"""Judging a frame: decoded whole, not black, not the same as the one before."""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from litrig.base.pictures import decode_codes
from litrig.base.radiometry import U8, clipped_share, sharpness

DARKEST_MEAN = 0.002


@dataclass(frozen=True)
class Quality:
    """What a look at a frame tells.

    Attributes
    ----------
    mean : mean of the display values, 0..1
    clipped : share of pixels with a channel at its upper end
    sharpness : see `litrig.base.radiometry.sharpness`
    same_as_previous : bit for bit what the camera delivered before: it is frozen
    """

    mean: float
    clipped: float
    sharpness: float
    same_as_previous: bool

    @property
    def fault(self) -> str:
        """Say what makes the frame useless; empty if nothing does."""
        if self.same_as_previous:
            return "is bit for bit the one before: the camera is frozen; unplug it and plug it in again"
        if self.mean < DARKEST_MEAN:
            return "is black; check lamp, lens cap and exposure"
        return ""

    def as_json(self) -> Mapping[str, float | bool]:
        """Return it as the journal has it."""
        return {key: value if isinstance(value, bool) else round(value, 6) for key, value in asdict(self).items()}


class Inspector:
    """Looks at one frame after the other."""

    def __init__(self) -> None:
        self._previous = b""

    def inspect(self, content: bytes, ending: str, source: str) -> tuple[U8, Quality]:
        """Decode a frame whole and judge it.

        Raises
        ------
        FormatError
            It is cut short or damaged.
        """
        codes = np.asarray(decode_codes(content, ending, source), np.uint8)
        digest = hashlib.sha256(content).digest()
        same, self._previous = digest == self._previous, digest
        grey = codes.mean(axis=-1, dtype=np.float32) / 255
        return codes, Quality(float(grey.mean()), clipped_share(codes), sharpness(grey), same)
