"""What varies over a surface that is made of decomposed MatCaps (the MatCap paper, figures 14 to 16)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Variation:
    """Pictures that are laid on by a mesh's texture coordinates, row 0 at v = 1; None is none.

    Attributes
    ----------
    low_colours, high_colours : (H, W, 3) factors on the light of the halves
    roughness : (H, W) 0 for the material's own, 1 for the roughest
    roughest : filter sizes ν of the low and the high frequencies where the roughness is 1; one that is smaller than the
        material's own changes nothing
    openness : (H, W) 1 where nothing occludes, with that of the mesh's vertices
    materials : (H, W) whole numbers: which of several MatCaps is there
    """

    low_colours: F32 | None = None
    high_colours: F32 | None = None
    roughness: F32 | None = None
    roughest: tuple[float, float] = (0.0, 0.0)
    openness: F32 | None = None
    materials: F32 | None = None


NONE = Variation()
