"""A MatCap's low and high frequencies, akin to diffuse light and gloss (the MatCap paper, section 4.1)."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from processing.matcap.disc import check_disc, disc_normals
from processing.matcap.separation.continuous import shadings_of
from processing.matcap.separation.discrete import dilate, erode
from processing.matcap.separation.envelope import outermost
from processing.matcap.separation.known import NOTHING, Ignored, holding, known_pixels
from processing.matcap.separation.pixel_tree import grow_tree, tile_order
from processing.matcap.separation.support import support

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bools = NDArray[np.bool_]
Form = Literal["continuous", "discrete"]

TOLERANCE = 1e-4
"""Of the brightest value: a third of the darkest step of 8-bit sRGB."""


@dataclass(frozen=True)
class Separation:
    """A picture's two layers.

    Attributes
    ----------
    low, high : (S, S, 3) float64, linear light ≥ 0; 0 outside the disc
    known : (S, S) bool, the pixels that show the sphere and nothing else
    """

    low: F64
    high: F64
    known: Bools


def separate(
    picture: NDArray[np.floating],
    *,
    form: Form = "continuous",
    covered: Bools | None = None,
    ignored: Ignored = NOTHING,
    tolerance: float = TOLERANCE,
    source: str = "the MatCap",
) -> Separation:
    """Take a MatCap apart, channel by channel.

    Parameters
    ----------
    picture : (S, S, 3) linear light ≥ 0, the disc inscribed in the square, row 0 on top
    form : `continuous` asks for light from all directions, `discrete` for those of pixels, as the paper does
    covered : (S, S), what a mask leaves of the picture; the rest holds nothing down, as what lies outside the disc
    ignored : what of the disc is no data either
    tolerance : how much brighter than by all constraints the continuous form may be, in parts of a channel's brightest
        value. 0 heeds them all
    source : what to call the picture in errors

    Raises
    ------
    InputError
        The picture is no MatCap, or nothing of it is left.
    """
    check_disc(picture, source)
    light = np.asarray(picture, np.float64)
    known = known_pixels(picture, covered, ignored.rim_px)
    if not known.any():
        raise InputError(f"{source}: no pixel of the disc is left; mask less, or give a smaller rim")
    normals, inside = disc_normals(len(light))
    rows, columns = np.nonzero(inside)
    order, codes = tile_order(rows, columns)
    rows, columns = rows[order], columns[order]
    tree = grow_tree(normals[rows, columns], codes)
    seen = known[rows, columns]
    part = tree if seen.all() else tree.part(seen)
    corners = outermost(part.normals)

    def open_channel(channel: int) -> F64:
        values: F64 = light[rows, columns, channel]
        held, chosen, ends = values[seen], part, corners
        holds = holding(held, ignored)
        if not holds.any():
            return values
        if not holds.all():
            held, chosen = held[holds], part.part(holds)
            ends = outermost(chosen.normals)
        if form == "continuous":
            opened = support(shadings_of(held, chosen, ends, tolerance), tree)
        else:
            opened = dilate(erode(held, chosen), chosen, tree)
        under: F64 = np.clip(opened, 0, values)
        return under

    low = np.zeros_like(light)
    with ThreadPoolExecutor() as pool:
        for channel, opened in enumerate(pool.map(open_channel, range(3))):
            low[rows, columns, channel] = opened
    high: F64 = np.where(inside[..., None], light, 0) - low
    return Separation(low, high, known)
