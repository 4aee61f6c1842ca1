"""A MatCap taken apart into two dual paraboloid maps of white light and what the material makes of it (section 4).

Each component is divided by its base colour, and spread over all directions by its slope; what the disc does not show
is filled in. What the maps lack of the disc is kept beside them.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.table_normals import TableNormal
from processing.matcap.base_colour import white_patch
from processing.matcap.disc import check_disc, disc_normals, spread_out
from processing.matcap.filter import slope_of
from processing.matcap.half_floats import rounded
from processing.matcap.model import Component, DecomposedMatcap
from processing.matcap.remainder import with_remainder
from processing.matcap.unwarping.blind_spot import filled_from_rim, lay_painted, lay_spot, rim_place
from processing.matcap.unwarping.warp import unwarped

F32 = NDArray[np.float32]
Bools = NDArray[np.bool_]
Fill = Literal["guided", "harmonic"]

SMALLEST_SIZE, LARGEST_BY_DEFAULT, LARGEST_SIZE = 64, 2048, 8192
_FINER = 2
_ALIGNED = 16


@dataclass(frozen=True)
class Filter:
    """What a component's material does to light.

    Attributes
    ----------
    size : ν, variance in radians squared
    slope : μ, 0 to 1
    """

    size: float
    slope: float

    @classmethod
    def of_size(cls, size: float) -> "Filter":
        """Take the slope that goes with a size (the MatCap paper, section 3.1)."""
        return cls(size, slope_of(size))

    @classmethod
    def of_slope(cls, slope: float) -> "Filter":
        """Take the size that goes with a slope."""
        return cls((math.sqrt(0.09 + 4.4 * (1 - slope)) - 0.3) / 2.2, slope)


def decompose(
    low: NDArray[np.floating],
    high: NDArray[np.floating],
    known: Bools | None,
    filters: tuple[Filter, Filter],
    *,
    size: int | None = None,
    fill: Fill = "guided",
    painted: tuple[F32, F32] | None = None,
    table_normal: TableNormal = TableNormal.RECTIFIED,
    source: str = "",
) -> DecomposedMatcap:
    """Take a MatCap apart whose low and high frequencies are known.

    Parameters
    ----------
    low, high : (S, S, 3) linear light ≥ 0 whose sum is the MatCap
    known : (S, S), the pixels that show the sphere; None for all of the disc
    filters : of the low and of the high one
    size : side of the maps; by default twice that of the disc, up to 2048
    fill : how the blind spot goes on from its rim
    painted : back maps of low and high, (P, P, 3) white light, whose blind spot is taken instead
    table_normal : how pictures in perspective are to ask the maps
    source : digest of the MatCap

    Raises
    ------
    InputError
        The layers are no MatCaps or of two sizes, or a parameter is out of range.
    """
    check_disc(low, "the low layer")
    check_disc(high, "the high layer")
    if low.shape != high.shape:
        raise InputError(f"layers of {len(low)} and {len(high)} pixels on a side are of no one MatCap; give one size")
    for name, chosen in zip(("low", "high"), filters, strict=True):
        if not (0 <= chosen.slope <= 1 and 0 <= chosen.size < math.inf):
            raise InputError(f"the {name} filter's slope {chosen.slope:g} and size {chosen.size:g} are of no material")
    _, inside = disc_normals(len(low))
    seen = inside if known is None else inside & known
    if not seen.any():
        raise InputError("no pixel of the disc is left; mask less")
    chosen_size = size or fitting_size(len(low))
    if not SMALLEST_SIZE // 8 <= chosen_size <= LARGEST_SIZE:
        raise InputError(f"maps of {chosen_size} texels on a side; give 8 to {LARGEST_SIZE}")

    def made(index: int) -> Component:
        layer = np.asarray((low, high)[index], np.float32)
        given = None if painted is None else painted[index]
        return _component(layer, seen, filters[index], chosen_size, fill, given)

    with ThreadPoolExecutor() as pool:
        low_part, high_part = pool.map(made, range(2))
    return DecomposedMatcap(low_part, high_part, table_normal, source, picture_size=len(low))


def fitting_size(side: int) -> int:
    """Return the side of maps that lose little of a disc of that side: twice as much, from 64 to 2048."""
    return min(max(math.ceil(_FINER * side / _ALIGNED) * _ALIGNED, SMALLEST_SIZE), LARGEST_BY_DEFAULT)


def _component(layer: F32, known: Bools, chosen: Filter, size: int, fill: Fill, painted: F32 | None) -> Component:
    colour = white_patch(layer, known)
    balanced = np.divide(layer, np.array(colour, np.float32), dtype=np.float32)
    disc = spread_out(balanced, known)
    sides = unwarped(disc, chosen.slope, size)
    spot, reach = filled_from_rim(disc, chosen.slope, guided=fill == "guided"), rim_place(chosen.slope, len(layer))
    for texels, behind in zip(sides, (False, True), strict=True):
        lay_spot(texels, spot, reach, behind=behind)
        if painted is not None:
            lay_painted(texels, painted, chosen.slope, behind=behind)
    front, back = (rounded(texels) for texels in sides)
    return with_remainder(Component(front, back, colour, chosen.slope, chosen.size), disc)
