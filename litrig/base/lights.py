"""Where the lights of a set of pictures were, from whichever file says so."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

MOST_LIGHTS = 10_000


@dataclass(frozen=True)
class Lights:
    """One light a picture.

    Attributes
    ----------
    names : picture names without folders, in the file's order; None if the file names none, and order is all there is
    directions : (N, 3) float64, unit, view frame, sample to light
    vectors : (N, 3) what the file holds, where its vectors are not of length 1: directions written carelessly, or
        positions in a unit that it does not say; else None
    positions_mm : (N, 3) in the view frame, from the point of the sample at the picture's centre; None if not known
    picture_width_mm : how much of the sample the picture's width covers. For a near light it is the ratio of position
        and width that counts
    gains : (N, 3) by what the pictures' linear R, G, B are to be multiplied, to make unequal lamps equal; None if equal
    """

    names: tuple[str, ...] | None
    directions: F64
    vectors: F64 | None = None
    positions_mm: F64 | None = None
    picture_width_mm: float | None = None
    gains: F64 | None = None

    def __len__(self) -> int:
        return len(self.directions)
