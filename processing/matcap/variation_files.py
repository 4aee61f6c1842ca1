"""Reading what varies over a surface from pictures."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.pictures import DISPLAY_ENDINGS, read_codes, read_encoded, read_linear
from processing.matcap.variation import Variation

F32 = NDArray[np.float32]
DEFAULT_ROUGHEST_DEG = 30.0


@dataclass(frozen=True)
class VariationFiles:
    """Which pictures are laid on; None is none.

    Attributes
    ----------
    low_colours, high_colours : light is multiplied by their linear light
    roughness, openness : grey, their stored values 0 to 1
    materials : each of its colours, in rising order, is one of several MatCaps
    roughest_deg : square root of the filter size where the roughness is 1, of the low and the high frequencies; 0
        leaves that half alone
    """

    low_colours: Path | None = None
    high_colours: Path | None = None
    roughness: Path | None = None
    openness: Path | None = None
    materials: Path | None = None
    roughest_deg: tuple[float, float] = (0.0, DEFAULT_ROUGHEST_DEG)

    def read(self, count: int) -> Variation:
        """Read all pictures.

        Parameters
        ----------
        count : of MatCaps to choose from

        Raises
        ------
        InputError, FormatError
            A picture is missing or damaged, or has more colours than there are MatCaps.
        """
        low, high = (float(np.radians(size) ** 2) for size in self.roughest_deg)
        return Variation(
            low_colours=None if self.low_colours is None else read_linear(self.low_colours),
            high_colours=None if self.high_colours is None else read_linear(self.high_colours),
            roughness=None if self.roughness is None else _grey(self.roughness),
            roughest=(low, high),
            openness=None if self.openness is None else _grey(self.openness),
            materials=None if self.materials is None else _numbers(self.materials, count),
        )


def _grey(path: Path) -> F32:
    """Read the mean of the channels as stored: such pictures hold numbers, not light."""
    values = read_encoded(path) if path.suffix.lower() in DISPLAY_ENDINGS else read_linear(path)
    return np.asarray(np.clip(values.mean(axis=-1), 0, 1), np.float32)


def _numbers(path: Path, count: int) -> F32:
    if path.suffix.lower() not in DISPLAY_ENDINGS - {".jpg", ".jpeg"}:
        raise InputError(f"{path}: material ids must keep their values; give a PNG or TIFF")
    codes = read_codes(path)
    colours, numbers = np.unique(codes.reshape(-1, 3), axis=0, return_inverse=True)
    if len(colours) > count:
        raise InputError(
            f"{path}: has {len(colours)} colours, and MatCaps for {count}; give each colour one with --with, or paint "
            "without soft edges"
        )
    return np.asarray(numbers.reshape(codes.shape[:2]), np.float32)
