"""`litrig ptm synth`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import JSON, PATH, FiniteRange

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from processing.ptm.model import Ptm
    from processing.ptm.synthesis.guidance import Guidance
    from processing.ptm.synthesis.quality import Quality
    from processing.ptm.synthesis.settings import Synthesis
    from processing.ptm.synthesis.suggestion import Suggestion

_SIDE_PX = click.IntRange(1, 1_000_000)


class _Block(click.types.IntParamType):
    """A number of pixels, or the word auto."""

    def convert(self, value: Any, param: click.Parameter | None, context: click.Context | None) -> Any:
        return None if value == "auto" else super().convert(value, param, context)


@click.command(epilog="Example: litrig ptm synth leather.ptm -o wall.ptm --size 1024 1024 --tileable --seed 7")
@click.argument("file", metavar="X", type=PATH)
@click.option(
    "-o",
    "--output",
    metavar="Y",
    type=PATH,
    required=True,
    help="What to write, in any form that `ptm convert` writes.",
)
@click.option(
    "--size", "size_px", metavar="W H", type=(_SIDE_PX, _SIDE_PX), help="Pixels of the result. Not with --fill."
)
@click.option(
    "--block",
    "block_px",
    metavar="N|auto",
    type=_Block(),
    default=30,
    show_default=True,
    help="Side of a block in pixels, its overlap included. auto: what the texture's autocorrelation suggests.",
)
@click.option(
    "--overlap",
    "overlap_px",
    metavar="N",
    type=int,
    help="Pixels that a block shares with its neighbours; a fifth of the block, 6 of 30, if left out.",
)
@click.option("--tileable", is_flag=True, help="Let the result go on where it ends, so that it repeats without a seam.")
@click.option(
    "--seed",
    type=click.IntRange(0, 2**63 - 1),
    default=0,
    show_default=True,
    help="Of the choice among good blocks. The same seed gives the same coefficients.",
)
@click.option(
    "--tolerance",
    type=FiniteRange(0),
    default=0.1,
    show_default=True,
    metavar="T",
    help="Blocks whose squared distance is within 1 + T times the best's are good.",
)
@click.option(
    "--delta",
    type=FiniteRange(0),
    default=0.004,
    show_default=True,
    metavar="D",
    help="So are blocks that differ by no more than D from what is there (RMS, where 1 is white).",
)
@click.option(
    "--join",
    type=click.Choice(["cut", "blend"]),
    default="cut",
    show_default=True,
    help="Cut overlaps along the path of least difference, or blend them.",
)
@click.option(
    "--copies",
    type=click.Choice(["avoid", "allow"]),
    default="avoid",
    show_default=True,
    help="allow: a block may go on with the source where its neighbour left off, which copies whole parts of it.",
)
@click.option(
    "--chroma",
    type=FiniteRange(0),
    default=1.0,
    show_default=True,
    metavar="W",
    help="Weight of colour beside luminance in comparisons of LRGB materials; 0 looks at luminance alone.",
)
@click.option(
    "--over",
    "domain",
    type=click.Choice(["square", "disc", "hemisphere"]),
    help="Over which lights reflectance is compared: the square of (u, v) (Legendre polynomials, the default of ptm), "
    "the unit disc, or solid angle (the default of hsh).",
)
@click.option(
    "--search",
    type=click.Choice(["fft", "svd", "dct", "haar", "walsh", "brute"]),
    default="fft",
    show_default=True,
    help="How blocks are found: Fourier transforms, rejection by projections on one of four sets of kernels, or one by "
    "one. All find the same.",
)
@click.option("--source", "more", metavar="X2", type=PATH, multiple=True, help="Another material to take blocks from.")
@click.option(
    "--guide", metavar="IMAGE", type=PATH, help="A grey picture of where the result should be dark and bright."
)
@click.option(
    "--guide-source",
    "guide_sources",
    metavar="IMAGE",
    type=PATH,
    multiple=True,
    help="What --guide is compared with, a picture of X's size, then one for each --source. If left out, how bright a "
    "place of the source is among all.",
)
@click.option(
    "--guide-weight", type=FiniteRange(0), metavar="W", help="Weight of --guide beside the texture; 1 if left out."
)
@click.option(
    "--fill",
    "mask",
    metavar="MASK",
    type=PATH,
    help="Replace what is white in a picture of X's size by what the rest of X looks like.",
)
@JSON
def synth(  # one option each
    file: Path,
    output: Path,
    size_px: tuple[int, int] | None,
    block_px: int | None,
    overlap_px: int | None,
    guide: Path | None,
    guide_sources: tuple[Path, ...],
    guide_weight: float | None,
    more: tuple[Path, ...],
    mask: Path | None,
    as_json: bool,
    **choices: Any,
) -> None:
    """Make a material of any size that looks like a captured one, under every light.

    Blocks of the source's reflectance functions are laid side by side, each chosen at random among those that go well
    with what is there already (Hel-Or, Malzbender, Gelb: Synthesis and Rendering of 3D Textures). It suits textures:
    what looks alike all over.
    """
    from dataclasses import replace

    from litrig.base.console import reporting
    from processing.ptm.files.either import check_form, read_any, write_any
    from processing.ptm.synthesis.fill import fill
    from processing.ptm.synthesis.quality import measure
    from processing.ptm.synthesis.settings import Synthesis
    from processing.ptm.synthesis.suggestion import default_overlap, suggest
    from processing.ptm.synthesis.synthesize import check_room, synthesize

    _check_use(size_px, guide, guide_sources, guide_weight, mask, choices)
    names = [str(path) for path in (file, *more)]
    materials = [read_any(path) for path in (file, *more)]
    check_form(output, materials[0].basis)
    size = materials[0].shape if size_px is None else size_px[::-1]
    check_room(size, materials)
    hole = None if mask is None else _read_mask(mask, materials[0].shape)
    chosen = Synthesis(**choices) if guide_weight is None else Synthesis(**choices, guide_weight=guide_weight)
    suggestion = suggest(materials, names, chosen) if hole is None else None
    if block_px is None:
        block_px = suggestion.block_px if suggestion else suggest(materials, names, chosen, hole).block_px
    chosen = replace(chosen, block_px=block_px, overlap_px=overlap_px or default_overlap(block_px))
    guidance = None if guide is None else _read_guidance(guide, guide_sources, materials, names, size, block_px)
    with reporting() as report:
        if hole is not None:
            result = fill(materials, hole, chosen, names=names, report=report)
        else:
            result = synthesize(materials, size, chosen, names=names, guidance=guidance, report=report)
        write_any(output, result.material)
    quality = measure(result, materials, block_px)
    _tell(output, result.material.shape, chosen, quality, suggestion, as_json=as_json)


def _check_use(
    size_px: tuple[int, int] | None,
    guide: Path | None,
    guide_sources: tuple[Path, ...],
    guide_weight: float | None,
    mask: Path | None,
    choices: dict[str, Any],
) -> None:
    if size_px is None and mask is None:
        raise click.UsageError("say how large the result is: --size W H; or what to replace: --fill MASK")
    if mask is not None:
        if size_px is not None:
            raise click.UsageError("--fill keeps the size of X; leave --size out")
        if guide is not None or choices["tileable"]:
            raise click.UsageError("--fill goes with neither --guide nor --tileable")
        if choices["search"] not in ("fft", "brute"):
            raise click.UsageError("--fill searches by fft or brute: every hole has neighbourhoods of its own")
    if guide is None and (guide_sources or guide_weight is not None):
        raise click.UsageError("--guide-source and --guide-weight are about --guide; give that too")


def _read_grey(path: Path) -> "NDArray[np.float32]":
    """Read a picture's values as they are stored, 0..1."""
    import numpy as np

    from litrig.base.pictures import read_encoded

    return np.asarray(np.clip(read_encoded(path).mean(axis=-1), 0, 1), np.float32)


def _read_mask(path: Path, shape: tuple[int, int]) -> "NDArray[np.bool_]":
    from litrig.base.errors import InputError

    mask = _read_grey(path) > 0.5
    if mask.shape != shape:
        raise InputError(
            f"{path}: {mask.shape[1]} × {mask.shape[0]} pixels, where the material has {shape[1]} × {shape[0]}; make "
            "the mask of its size"
        )
    return mask


def _read_guidance(
    guide: Path,
    guide_sources: tuple[Path, ...],
    materials: "list[Ptm]",
    names: list[str],
    size: tuple[int, int],
    block_px: int,
) -> "Guidance":
    from litrig.base.errors import InputError
    from processing.ptm.synthesis.guidance import Guidance, brightness_ranks, stretched

    if not guide_sources:
        return Guidance(stretched(_read_grey(guide), size), brightness_ranks(materials, block_px))
    if len(guide_sources) != len(materials):
        raise InputError(
            f"{len(guide_sources)} --guide-source for {len(materials)} materials; give one for each, X first, or none"
        )
    maps = tuple(_read_grey(path) for path in guide_sources)
    for path, one, material, name in zip(guide_sources, maps, materials, names, strict=True):
        if one.shape != material.shape:
            raise InputError(
                f"{path}: {one.shape[1]} × {one.shape[0]} pixels, where {name} has {material.shape[1]} × "
                f"{material.shape[0]}; make the map of its size"
            )
    return Guidance(stretched(_read_grey(guide), size), maps)


def _tell(
    output: Path,
    shape: tuple[int, int],
    settings: "Synthesis",
    quality: "Quality",
    suggestion: "Suggestion | None",
    *,
    as_json: bool,
) -> None:
    height, width = shape
    facts = {
        "width": width,
        "height": height,
        "block": settings.block_px,
        "overlap": settings.overlap_px,
        "seed": settings.seed,
        **({} if suggestion is None else {"suggested_block": suggestion.block_px, "period": suggestion.period_px}),
        **quality.facts(),
    }
    if as_json:
        click.echo(json.dumps(facts))
        return
    click.echo(
        f"{output}: {width} × {height} pixels of blocks of {settings.block_px}, {settings.overlap_px} overlapping"
    )
    click.echo(f"seams: {quality.seam_energy:.2f} times the energy of what is beside them")
    if settings.tileable:
        click.echo(
            f"across the ends: percentile {quality.wrap_percentile:.0f} of what is across inner columns and rows"
        )
    click.echo(
        f"under 8 lights: brightness within {quality.brightness_off:.1%}, contrast within {quality.contrast_off:.1%}"
    )
    click.echo(
        f"copied in pieces larger than a block: {quality.copied:.1%}, the largest {quality.largest_copy_px} pixels"
    )
    if quality.rejected:
        shares = ", ".join(f"{share:.1%}" for share in quality.rejected[:3])
        click.echo(f"rejected after the first projections: {shares}")
    if suggestion is not None and not 0.5 <= settings.block_px / suggestion.block_px <= 2:
        click.echo(f"the texture suggests blocks of {suggestion.block_px}: --block auto")
