"""Block-based synthesis (Synthesis and Rendering of 3D Textures, section IV)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from litrig.base.progress import Progress, Report, silent
from processing.ptm.synthesis.canvas import Canvas, Taken
from processing.ptm.synthesis.joining import new_weight
from processing.ptm.synthesis.layout import Layout, known_part
from processing.ptm.synthesis.search.problem import NO_IDS, Candidates, Rule, Search, Target
from processing.ptm.synthesis.settings import Synthesis

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]


class Parts(NamedTuple):
    """What blocks are made of.

    Attributes
    ----------
    planes : one (H, W, P) float32 a source
    compared : how many of the planes are compared
    candidates : the blocks of the sources, with the same numbers of rows and columns
    search : finds the good ones among them
    rule : says which are good
    """

    planes: Sequence[F32]
    compared: int
    candidates: Candidates
    search: Search
    rule: Rule


def grow(
    parts: Parts, layout: Layout, settings: Synthesis, guide: F32 | None = None, report: Report = silent
) -> Canvas:
    """Fill a layout, block after block: a good block at random, joined to what is there.

    Parameters
    ----------
    guide : (H, W, G) of the layout's canvas, None for no guidance
    """
    random = np.random.default_rng(settings.seed)
    canvas = Canvas(layout.shape, parts.planes[0].shape[2])
    side = layout.block_px
    for done, (y, x, edges) in enumerate(layout.cells, start=1):
        place = canvas.window(y, x, side)
        old, known = canvas.values[place], known_part(edges, side)
        wanted = np.zeros((side, side, 0), np.float32) if guide is None else guide[place]
        banned = banned_near(canvas, parts.candidates, y, x, settings)
        target = Target(old[..., : parts.compared], known, wanted, banned)
        number = choose(parts, target, random)
        source, source_y, source_x = parts.candidates.place(number)
        new = parts.planes[source][source_y : source_y + side, source_x : source_x + side]
        weight = new_weight(settings.join, old, new, parts.compared, edges)
        canvas.put(Taken(y, x, source, source_y, source_x), new, weight)
        report(Progress("synthesising", done, len(layout.cells), "blocks"))
    return canvas


def turn_to_calmest(canvas: Canvas, compared: int) -> None:
    """Let a torus begin at the row and the column across which it changes least; it is the same wherever it begins.

    So the ends of a tile lie inside blocks, and not along their borders.
    """
    values = canvas.values[..., :compared]
    steps = [
        np.square(values - np.roll(values, 1, axis=axis)).sum(axis=(1 - axis, 2), dtype=np.float64) for axis in (0, 1)
    ]
    canvas.turn(int(np.argmin(steps[0])), int(np.argmin(steps[1])))


def banned_near(canvas: Canvas, candidates: Candidates, y: int, x: int, settings: Synthesis) -> I64:
    """Find the blocks that must not be taken here, for they would copy the source on; none if no other is left."""
    if settings.copies == "allow":
        return NO_IDS
    banned = canvas.continuations(y, x, candidates, settings.overlap_px)
    banned = banned[candidates.allowed[banned]]
    return banned if len(banned) < len(candidates.allowed_ids) else NO_IDS


def choose(parts: Parts, target: Target, random: np.random.Generator) -> int:
    """Choose one of the good blocks at random; any at all where there is nothing to go by."""
    if target.known.any() or target.guide.shape[2]:
        found = parts.search.matches(target, parts.rule)
    else:
        found = parts.candidates.allowed_ids
    return int(found[random.integers(len(found))])
