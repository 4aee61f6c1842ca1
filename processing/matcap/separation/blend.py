"""How two layers of a picture go together, and what the second is where the picture and the first are known.

A layer that multiplies is not among them: where the first is black it could not be told.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError

Floats = NDArray[np.floating]
Blend = Literal["add", "screen", "lighten"]


def blended(low: Floats, high: Floats, blend: Blend) -> Floats:
    """Put two layers together: low + high, 1 − (1 − low)(1 − high), or the brighter of the two."""
    match blend:
        case "add":
            return low + high
        case "screen":
            return low + high - low * high
        case "lighten":
            return np.maximum(low, high)


def above(picture: Floats, low: Floats, blend: Blend) -> Floats:
    """Return the layer ≥ 0 that makes the picture out of a low one, which is nowhere brighter.

    Raises
    ------
    InputError
        A picture brighter than 1 is to be screened.
    """
    match blend:
        case "add":
            return picture - low
        case "screen":
            if picture.max(initial=0) > 1:
                raise InputError(
                    f"a picture as bright as {picture.max():.3g} cannot be made by screen, which ends at 1; use add"
                )
            room = 1 - low
            return np.where(room > 0, (picture - low) / np.where(room > 0, room, 1), 0)
        case "lighten":
            return np.where(picture > low, picture, 0)
