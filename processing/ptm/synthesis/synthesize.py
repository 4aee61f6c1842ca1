"""From captured materials to a new one of any size: the whole way, in memory."""

import hashlib
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from litrig.base.errors import InputError
from litrig.base.progress import Report, silent
from processing.ptm.model import Ptm
from processing.ptm.synthesis.canvas import Canvas
from processing.ptm.synthesis.grow import Parts, grow, turn_to_calmest
from processing.ptm.synthesis.guidance import Guidance
from processing.ptm.synthesis.layout import plain_layout, tile_layout
from processing.ptm.synthesis.orthonormal import check_domain
from processing.ptm.synthesis.search.choose import make_search
from processing.ptm.synthesis.search.problem import Candidates, Mask, Rule, Search, Source
from processing.ptm.synthesis.settings import Synthesis
from processing.ptm.synthesis.texture import Textures, to_textures

F32 = NDArray[np.float32]
_BYTES_A_VALUE = 16
"""Canvas, coefficients, a temporary each, and the indices of a pixel."""
_BYTES_A_SOURCE_VALUE = 48


@dataclass(frozen=True)
class Synthesised:
    """A result and how it came about.

    Attributes
    ----------
    material : the new one
    canvas : where its pixels come from; it may be larger than the material, to the right and below
    textures : the sources as they were compared
    search : the strategy, with what it counted
    """

    material: Ptm
    canvas: Canvas
    textures: Textures
    search: Search


def synthesize(
    materials: Sequence[Ptm],
    size: tuple[int, int],
    settings: Synthesis | None = None,
    *,
    names: Sequence[str] | None = None,
    guidance: Guidance | None = None,
    report: Report = silent,
) -> Synthesised:
    """Make a material of another size that looks like captured ones under every light.

    Parameters
    ----------
    materials : sources, of one basis and kind
    size : height and width in pixels
    names : of the sources, for errors
    guidance : what the result should be like, and where

    Returns
    -------
    result : its coefficients are those of a source, bit by bit, wherever blocks are not blended

    Raises
    ------
    InputError
        A source is smaller than a block or not finite, sources differ in kind, or there is no memory for the result.
    """
    settings = settings or Synthesis()
    names = names or [f"source {index}" for index in range(len(materials))]
    check_room(size, materials)
    height, width = size
    lay_out = tile_layout if settings.tileable else plain_layout
    layout = lay_out(height, width, settings.block_px, settings.overlap_px)
    check_block(materials, names, settings.block_px)
    parts, textures = prepare(materials, names, settings, guidance)
    guide = None if guidance is None else weighted(guidance.target_on(layout.shape), textures, settings)
    canvas = grow(parts, layout, settings, guide, report)
    if settings.tileable and guidance is None:
        turn_to_calmest(canvas, textures.compared)
    material = finish(canvas, textures, materials, size, settings)
    return Synthesised(material, canvas, textures, parts.search)


def prepare(
    materials: Sequence[Ptm],
    names: Sequence[str],
    settings: Synthesis,
    guidance: Guidance | None = None,
    allowed: Sequence[Mask | None] | None = None,
) -> tuple[Parts, Textures]:
    """Bring sources into the space of comparison and prepare the search."""
    domain = check_domain(materials[0].basis, settings.domain, names[0])
    textures = to_textures(materials, names, domain, settings.chroma)
    sources = []
    for index, planes in enumerate(textures.planes):
        guide = np.zeros((*planes.shape[:2], 0), np.float32)
        if guidance is not None:
            guide = weighted(guidance.sources[index], textures, settings)
        texture = np.ascontiguousarray(planes[..., : textures.compared])
        sources.append(Source(texture, guide, None if allowed is None else allowed[index]))
    candidates = Candidates(sources, settings.block_px)
    rule = Rule(settings.tolerance, settings.delta**2 * textures.distance_unit)
    search = make_search(settings.search, candidates)
    return Parts(textures.planes, textures.compared, candidates, search, rule), textures


def weighted(guide: F32, textures: Textures, settings: Synthesis) -> F32:
    """Scale a map (H, W) to (H, W, 1): with weight 1, what differs by 1 in it is as far apart as black and white."""
    return guide[..., None] * np.float32(settings.guide_weight * np.sqrt(textures.distance_unit))


def finish(
    canvas: Canvas, textures: Textures, materials: Sequence[Ptm], size: tuple[int, int], settings: Synthesis
) -> Ptm:
    """Turn a canvas into a material; pixels that are no mixture get their source's own coefficients."""
    height, width = size
    crop = np.s_[:height, :width]
    first = materials[0]
    terms, _, _, channels = first.coefficients.shape
    coefficients = np.zeros((terms, height, width, channels), np.float32)
    colour = np.zeros((height, width, 3 if first.colour is not None else 0), np.float32)
    sources, rows, columns = (part[crop] for part in canvas.origins())
    mixed = canvas.mixed[crop]
    for index, material in enumerate(materials):
        mine = ~mixed & (sources == index)
        place = rows[mine], columns[mine]
        coefficients[:, mine] = material.coefficients[:, place[0], place[1]]
        if material.colour is not None:
            colour[mine] = material.colour[place]
    coefficients[:, mixed], colour[mixed] = textures.pixels(canvas.values[crop][mixed])
    source = _digest(materials, size, settings)
    return Ptm(coefficients, None if first.colour is None else colour, first.space, source, first.basis)


def check_block(materials: Sequence[Ptm], names: Sequence[str], block_px: int) -> None:
    """Refuse sources that hold no block."""
    for material, name in zip(materials, names, strict=True):
        least = min(material.shape)
        if least < block_px:
            height, width = material.shape
            raise InputError(
                f"{name}: {width} × {height} pixels hold no block of {block_px}; choose --block {least} or less, or a "
                "larger source"
            )


def check_room(size: tuple[int, int], materials: Sequence[Ptm]) -> None:
    """Refuse what would not fit into the machine's memory, before any of it is taken."""
    terms, _, _, channels = materials[0].coefficients.shape
    planes = terms * channels + (0 if materials[0].colour is None else 3)
    needed = size[0] * size[1] * (planes + 3) * _BYTES_A_VALUE
    needed += sum(m.shape[0] * m.shape[1] for m in materials) * planes * _BYTES_A_SOURCE_VALUE
    present = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if needed > present:
        raise InputError(
            f"{size[1]} × {size[0]} pixels need {needed / 2**30:.1f} GiB of memory and this machine has "
            f"{present / 2**30:.1f}; choose a smaller --size, or --tileable, which repeats without a seam"
        )


def _digest(materials: Sequence[Ptm], size: tuple[int, int], settings: Synthesis) -> str:
    """Name what a result was made of; two of one name have the same coefficients."""
    made_of = (tuple(material.source for material in materials), size, sorted(asdict(settings).items()))
    return "synthesis:" + hashlib.sha256(repr(made_of).encode()).hexdigest()
