"""An Anisotropic MatCap in memory."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.table_normals import TableNormal

Invariance = int | Literal["isotropic"]


class TangentAngle(StrEnum):
    """What k counts."""

    PICTURE = "picture"
    """The angle of the tangent's picture, that is of its x and y in the view frame (the paper's equation 3)."""
    SURFACE = "surface"
    """The tangent's angle in the surface, after the smallest rotation that takes the table normal to z."""


@dataclass(frozen=True)
class Amc:
    """A table of pre-lit colour over normal and tangent direction (the AMC paper, section 4).

    Attributes
    ----------
    slices : (D, S, S, 3) float32, linear light; [j, row, column] with row 0 at n_y = +1 and texel centres at
        n_x = (2·column + 1)/S − 1; slice j at tangent angle 360·j/(R·D) degrees; dilated past the disc of normals
    valid : (D, S, S) bool, where the slices hold what was seen
    invariance : R, or "isotropic" with D = 1: the material looks the same turned by 360°/R
    table_normal : how a perspective picture's normal is brought to the table
    slice_angles_deg : the tangent angle of every captured slice, as measured
    source : digest of the frames that it was built from
    tangent_angle : what the tangent angle of a slice is measured in
    """

    slices: NDArray[np.float32]
    valid: NDArray[np.bool_]
    invariance: Invariance
    table_normal: TableNormal = TableNormal.RECTIFIED
    slice_angles_deg: tuple[float, ...] = ()
    source: str = ""
    tangent_angle: TangentAngle = TangentAngle.PICTURE

    @property
    def repeats(self) -> int:
        """By how much a lookup multiplies k; an isotropic table has one slice, so that k is of no matter."""
        return 1 if self.invariance == "isotropic" else int(self.invariance)
