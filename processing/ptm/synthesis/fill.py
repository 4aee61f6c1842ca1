"""Growing from a given border: a hole in a captured material is filled with what the rest of it looks like."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy import ndimage

from litrig.base.errors import InputError
from litrig.base.progress import Progress, Report, silent
from processing.ptm.model import Ptm
from processing.ptm.synthesis.canvas import Canvas, Taken
from processing.ptm.synthesis.graph_cut import graph_cut_weight
from processing.ptm.synthesis.grow import Parts, banned_near, choose
from processing.ptm.synthesis.search.problem import Target
from processing.ptm.synthesis.settings import Synthesis
from processing.ptm.synthesis.synthesize import Synthesised, check_block, check_room, finish, prepare
from processing.ptm.synthesis.texture import emptied

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class _Hole:
    """What of a material is to be replaced.

    Attributes
    ----------
    hole : (H, W), what must be
    loose : (H, W), what may be: the hole and a ring round it, in which a border can run
    """

    hole: Mask
    loose: Mask


def fill(
    materials: Sequence[Ptm],
    hole: Mask,
    settings: Synthesis | None = None,
    *,
    names: Sequence[str] | None = None,
    report: Report = silent,
) -> Synthesised:
    """Fill a hole in the first material with blocks of its rest, and of further materials.

    Blocks are laid from the hole's border inwards: next is always the one of which most is known. Pixels more than an
    overlap away from the hole keep their bits.

    Parameters
    ----------
    hole : (H, W), of the first material's size

    Raises
    ------
    InputError
        No block lies outside the hole, the search cannot fill holes, or as `synthesize` raises.
    """
    settings = settings or Synthesis()
    names = names or [f"source {index}" for index in range(len(materials))]
    first, block_px = materials[0], settings.block_px
    if settings.tileable or settings.search not in ("fft", "brute"):
        raise InputError(f"{names[0]}: a hole is filled by --search fft or brute, and is no tile; leave the others out")
    check_room(first.shape, materials)
    check_block(materials, names, block_px)
    if not hole.any():
        raise InputError(f"{names[0]}: the mask marks no pixel of it to be filled; mark them white")
    usable = np.asarray(~sliding_window_view(hole, (block_px, block_px)).any(axis=(2, 3)), bool)
    if not usable.any() and len(materials) == 1:
        raise InputError(
            f"{names[0]}: no block of {block_px} pixels lies outside the mask; choose a smaller --block, or give "
            "another material as --source"
        )
    # What lies in the hole may be no number.
    cleaned = emptied(first, hole)
    sources = [cleaned, *materials[1:]]
    parts, textures = prepare(sources, names, settings, allowed=[usable, *(None for _ in materials[1:])])
    canvas = Canvas(first.shape, textures.planes[0].shape[2])
    canvas.values[:] = textures.planes[0]
    _lay(canvas, parts, _Hole(hole, ndimage.binary_dilation(hole, iterations=settings.overlap_px)), settings, report)
    filled = finish(canvas, textures, sources, first.shape, settings)
    kept = (canvas.block < 0) & ~canvas.mixed
    filled.coefficients[:, kept] = first.coefficients[:, kept]
    if filled.colour is not None and first.colour is not None:
        filled.colour[kept] = first.colour[kept]
    return Synthesised(filled, canvas, textures, parts.search)


def _lay(canvas: Canvas, parts: Parts, hole: _Hole, settings: Synthesis, report: Report) -> None:
    random = np.random.default_rng(settings.seed)
    side = settings.block_px
    places = _places(hole.hole, side, min(settings.overlap_px, side // 4))
    still_open = hole.hole.copy()
    for done in range(1, len(places) + 1):
        # Of those of which as much is known, the first in the order of rows.
        place = min(places, key=lambda one: int(still_open[one.window(side)].sum()))
        places.remove(place)
        window = place.window(side)
        known, takes_new = ~still_open[window], still_open[window] & place.inner(side)
        if takes_new.any():
            old = canvas.values[window]
            banned = banned_near(canvas, parts.candidates, place.y, place.x, settings)
            target = Target(old[..., : parts.compared], known, np.zeros((side, side, 0), np.float32), banned)
            source, source_y, source_x = parts.candidates.place(choose(parts, target, random))
            new = parts.planes[source][source_y : source_y + side, source_x : source_x + side]
            keeps_old = known & (~hole.loose[window] | place.frame(side, hole.hole.shape))
            if settings.join == "blend":
                weight = _ramp(keeps_old, takes_new, settings.overlap_px)
            else:
                difference = (old[..., : parts.compared] - new[..., : parts.compared]).astype(np.float64)
                error = np.einsum("ijk,ijk->ij", difference, difference)
                weight = graph_cut_weight(error, known, keeps_old, takes_new)
            weight = np.where(known | takes_new, weight, 0)
            canvas.put(Taken(place.y, place.x, source, source_y, source_x), new, weight.astype(np.float32))
            still_open[window] &= ~takes_new
        report(Progress("filling", done, done + len(places), "blocks"))


def _ramp(keeps_old: Mask, takes_new: Mask, width_px: int) -> F32:
    """Let the weight of the new rise from where old is kept to where new is taken."""
    from_new = ndimage.distance_transform_edt(~takes_new)
    if not keeps_old.any():
        return np.asarray(np.maximum(1 - from_new / width_px, 0), np.float32)
    from_old = ndimage.distance_transform_edt(~keeps_old)
    return np.asarray(from_old / (from_old + from_new), np.float32)


class _Place(NamedTuple):
    """A block's upper left pixel, and the rectangle that it is to fill: so far inside that a border has room round it.

    Attributes
    ----------
    rows, columns : first and last + 1 of the rectangle
    """

    y: int
    x: int
    rows: tuple[int, int]
    columns: tuple[int, int]

    def window(self, side: int) -> tuple[slice, slice]:
        return np.s_[self.y : self.y + side, self.x : self.x + side]

    def inner(self, side: int) -> Mask:
        inside = np.zeros((side, side), bool)
        rows, columns = (slice(a - o, b - o) for (a, b), o in ((self.rows, self.y), (self.columns, self.x)))
        inside[rows, columns] = True
        return inside

    def frame(self, side: int, shape: tuple[int, int]) -> Mask:
        """Return the outermost pixels that have neighbours outside the block, to which they must fit."""
        outer = np.zeros((side, side), bool)
        outer[0], outer[-1] = self.y > 0, self.y + side < shape[0]
        outer[:, 0] |= self.x > 0
        outer[:, -1] |= self.x + side < shape[1]
        return outer


def _places(hole: Mask, side: int, margin: int) -> list[_Place]:
    """Lay rectangles side by side over the hole, and a block round each that holds some of it."""
    step = side - 2 * margin
    starts, ends = zip(*(_ends(np.asarray(hole.any(axis=axis))) for axis in (1, 0)), strict=True)
    places = []
    for top in range(starts[0], ends[0], step):
        for left in range(starts[1], ends[1], step):
            rows, columns = (top, min(top + step, ends[0])), (left, min(left + step, ends[1]))
            if hole[slice(*rows), slice(*columns)].any():
                y, x = (
                    min(max(start - margin, 0), length - side)
                    for start, length in zip((top, left), hole.shape, strict=True)
                )
                places.append(_Place(y, x, rows, columns))
    return places


def _ends(line: Mask) -> tuple[int, int]:
    marked = np.flatnonzero(line)
    return int(marked[0]), int(marked[-1]) + 1
