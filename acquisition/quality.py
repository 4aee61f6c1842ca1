"""Looking at a frame: decoded whole, and judged by what a picture of its kind must be."""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from acquisition.plans import Step
from litrig.base.capture_folder.capture import Role
from litrig.base.pictures import decode_codes
from litrig.base.radiometry import U8, clipped_share, decode_srgb_codes, sharpness

DARKEST_MEAN = 0.002
MOST_CLIPPED = 0.05
LEAST_GAIN, LEAST_ADDED = 1.5, 0.0005
"""What a lamp must make of the ambient light (mean, linear) at least: so many times as much, and so much more."""
EVERY = 4
"""The mean light is that of every fourth pixel each way."""


@dataclass(frozen=True)
class Quality:
    """What a look at a frame tells.

    Attributes
    ----------
    mean : mean of the display values, 0..1
    light : mean of the linear light, 0..1
    clipped : share of pixels with a channel at its upper end
    sharpness : see `litrig.base.radiometry.sharpness`
    same_as_previous : bit for bit what the camera delivered before: it is frozen
    """

    mean: float
    light: float
    clipped: float
    sharpness: float
    same_as_previous: bool

    @property
    def remarks(self) -> tuple[str, ...]:
        """Say what a person should know of a frame that counts all the same."""
        return (f"{100 * self.clipped:.1f} % clipped",) if self.clipped > MOST_CLIPPED else ()

    def as_json(self) -> Mapping[str, float | bool]:
        """Return it as the journal has it."""
        return {key: value if isinstance(value, bool) else round(value, 6) for key, value in asdict(self).items()}


class Inspector:
    """Looks at one frame after the other.

    Parameters
    ----------
    ambient_light : mean linear light at the rig's own exposure with all lamps dark; None where they cannot be
    """

    def __init__(self, ambient_light: float | None = None) -> None:
        self.ambient_light = ambient_light
        self._previous = b""

    def inspect(self, content: bytes, ending: str, source: str, *, repeats: bool = False) -> tuple[U8, Quality]:
        """Decode a frame whole and measure it.

        Parameters
        ----------
        repeats : the camera itself delivered the same just before

        Raises
        ------
        FormatError
            It is cut short or damaged.
        """
        codes = np.asarray(decode_codes(content, ending, source), np.uint8)
        digest = hashlib.sha256(content).digest()
        same, self._previous = repeats or digest == self._previous, digest
        grey = codes.mean(axis=-1, dtype=np.float32) / 255
        light = float(decode_srgb_codes(codes[::EVERY, ::EVERY]).mean())
        return codes, Quality(float(grey.mean()), light, clipped_share(codes), sharpness(grey), same)

    def fault(self, step: Step, quality: Quality) -> str:
        """Say what makes a frame useless for its step; empty if nothing does."""
        if not step.lit or step.role is Role.DARK:
            return ""  # black may well be bit for bit the same black
        if quality.same_as_previous:
            return "is bit for bit the one before: the camera is frozen; unplug it and plug it in again"
        if quality.mean < DARKEST_MEAN:
            return "is black; check lamp, lens cap and exposure"
        if self.ambient_light is not None and step.aim is not None:
            ambient = self.ambient_light * 2**step.exposure_ev
            if quality.light < max(LEAST_GAIN * ambient, ambient + LEAST_ADDED * min(1.0, 2**step.exposure_ev)):
                lamp = f"lamp {step.aim.lamp}" if step.aim.lamp else "the lamp"
                return f"is hardly brighter than with all lamps dark: {lamp} did not light; check it and its cable"
        return ""
