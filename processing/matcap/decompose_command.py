"""`litrig matcap decompose`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import JSON, PATH, FiniteRange, check_output, echo_facts
from processing.matcap.split_command import separating

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from litrig.base.table_normals import TableNormal
    from processing.matcap.decompose import Filter
    from processing.matcap.separation.blend import Blend
    from processing.matcap.split_command import Separate

    F32 = NDArray[np.float32]


@click.command(epilog="Example: litrig matcap decompose clay.png -o clay.matcap.exr")
@click.argument("images", metavar="IMAGE|LOW HIGH", type=PATH, nargs=-1, required=True)
@click.option("-o", "--output", metavar="X.matcap.exr", type=PATH, required=True, help="What to write.")
@click.option(
    "--filter-sizes",
    type=FiniteRange(0, 10),
    nargs=2,
    metavar="NU_LOW NU_HIGH",
    help="The materials' filters: variances in radians squared. By default low is matt (0.467), and high is estimated.",
)
@click.option(
    "--slopes",
    type=FiniteRange(0, 1),
    nargs=2,
    metavar="MU_LOW MU_HIGH",
    help="How much the filters turn away from the view: 0 matt, 1 a mirror. By default as the filter sizes say.",
)
@click.option(
    "--size",
    type=click.IntRange(8, 8192),
    metavar="S",
    help="Side of the maps. By default twice that of the picture, up to 2048.",
)
@click.option(
    "--blind-spot",
    default="guided",
    show_default=True,
    metavar="guided|harmonic|IMAGE",
    help="What lies behind, where nothing on the disc looks: its rim continued as it changes there, or smoothed, or a "
    "back map painted by hand: a square picture of white light, or another X.matcap.exr.",
)
@click.option(
    "--blend",
    type=click.Choice(["add", "screen", "lighten"]),
    default="add",
    show_default=True,
    help="How HIGH lies over LOW, in linear light.",
)
@click.option(
    "--normal",
    type=click.Choice(["rectified", "view", "camera"]),
    default="rectified",
    show_default=True,
    help="How pictures in perspective are to ask the maps.",
)
@JSON
@separating
def decompose(
    images: tuple[Path, ...],
    output: Path,
    filter_sizes: tuple[float, float] | None,
    slopes: tuple[float, float] | None,
    size: int | None,
    blind_spot: str,
    blend: "Blend",
    normal: "TableNormal",
    as_json: bool,
    separated: "Separate",
) -> None:
    """Take a MatCap apart into light from all directions and what its material makes of it.

    IMAGE is split as by `litrig matcap split`; LOW and HIGH are layers that were made so, or by hand. A MatCap of
    Blender's, an EXR with passes diffuse and specular, has both in one. The result can be
    lit from elsewhere, and made of another material.
    """
    from litrig.base.console import reporting
    from litrig.base.progress import Progress
    from litrig.base.table_normals import TableNormal
    from processing.matcap.decompose import decompose as take_apart
    from processing.matcap.matcap_exr import ENDING, write_matcap

    if len(images) > 2:
        raise click.BadParameter(f"{len(images)} pictures; give one, or a low and a high layer", param_hint="IMAGE")
    check_output(output, ENDING)
    with reporting() as report:
        low, high, known, source = _layers(images, blend, separated)
        report(Progress("decompose", 1, 3, "layers"))
        painted = None if blind_spot in ("guided", "harmonic") else _painted(Path(blind_spot))
        filters, remarks = _filters(images, low, high, filter_sizes, slopes)
        report(Progress("decompose", 2, 3, "filters"))
        found = take_apart(
            low,
            high,
            known,
            filters,
            size=size,
            fill="harmonic" if blind_spot == "harmonic" else "guided",
            painted=painted,
            table_normal=TableNormal(normal),
            source=source,
        )
        report(Progress("decompose", 3, 3, "maps"))
    write_matcap(output, found)
    facts: dict[str, Any] = {"file": str(output), "size": len(found.low.front)}
    for name, component in (("low", found.low), ("high", found.high)):
        facts[f"{name}_filter_size"] = _short(component.filter_size)
        facts[f"{name}_slope"] = _short(component.slope)
        facts[f"{name}_base_colour"] = [_short(value) for value in component.base_colour]
    for remark in remarks:
        click.echo(remark, err=True)
    echo_facts(facts, as_json)


def _layers(
    images: tuple[Path, ...], blend: "Blend", separated: "Separate"
) -> "tuple[F32, F32, NDArray[np.bool_], str]":
    """Return low, high, the pixels known in them, and the digest of the files."""
    import hashlib

    from litrig.base.errors import InputError
    from processing.matcap.blender_exr import is_blender_matcap, read_blender_matcap
    from processing.matcap.disc import check_disc
    from processing.matcap.disc_file import read_disc
    from processing.matcap.separation.blend import blended
    from processing.matcap.separation.known import known_pixels

    if len(images) == 1 and blend != "add":
        raise InputError(f"{images[0]}: is no HIGH over a LOW; give two layers, or leave out --blend")
    if len(images) == 1 and is_blender_matcap(images[0]):
        separated.refuse_for_layers(images[0])
        low, high = read_blender_matcap(images[0])
        for layer in (low, high):
            check_disc(layer, str(images[0]))
        known = known_pixels(low + high, None)
    elif len(images) == 1:
        separation = separated(images[0])
        low, high = separation.low.astype("float32"), separation.high.astype("float32")
        known = separation.known
    else:
        separated.refuse_for_layers(images[0])
        first, second = (read_disc(image) for image in images)
        if first.colours.shape != second.colours.shape:
            raise InputError(
                f"{images[1]}: {len(second.colours)} pixels on a side, but {images[0]} has {len(first.colours)}; give "
                "layers of one size"
            )
        whole = blended(first.colours, second.colours, blend)
        known = known_pixels(whole, first.covered)
        low, high = first.colours, (whole - first.colours).clip(0).astype("float32")
    if not known.any():
        raise InputError(f"{images[0]}: no pixel of the disc is opaque; give layers that show the ball")
    digest = hashlib.sha256(b"".join(image.read_bytes() for image in images)).hexdigest()
    return low, high, known, digest


def _filters(
    images: tuple[Path, ...],
    low: "F32",
    high: "F32",
    sizes: tuple[float, float] | None,
    slopes: tuple[float, float] | None,
) -> "tuple[tuple[Filter, Filter], list[str]]":
    """Return the filters as they were given or are estimated, and what a person should know about that."""
    from processing.matcap.decompose import Filter
    from processing.matcap.filter import MATT_FILTER_SIZE

    remarks: list[str] = []
    if sizes is None and slopes is not None:
        return (Filter.of_slope(slopes[0]), Filter.of_slope(slopes[1])), remarks
    if sizes is None:
        high_size, remarks = _estimated(images, low, high)
        sizes = (MATT_FILTER_SIZE, high_size)
    filters = (Filter.of_size(sizes[0]), Filter.of_size(sizes[1]))
    if slopes is not None:
        filters = (Filter(sizes[0], slopes[0]), Filter(sizes[1], slopes[1]))
    return filters, remarks


def _estimated(images: tuple[Path, ...], low: "F32", high: "F32") -> tuple[float, list[str]]:
    """Estimate the filter of the high frequencies; that of the low ones is matt by how they are told apart."""
    from litrig.base.errors import InputError
    from processing.matcap.disc_file import cut_off_at_white
    from processing.matcap.estimate.estimate import estimate_filter_size

    clipped = cut_off_at_white(images[0], low + high)
    try:
        found = estimate_filter_size(high, clipped=clipped)
    except InputError as error:
        raise InputError(f"{images[0]}: its filters cannot be estimated ({error}); give --filter-sizes") from error
    return found.filter_size, [f"high: {remark}" for remark in found.remarks]


def _short(number: float) -> float:
    return float(f"{number:.5g}")


def _painted(path: Path) -> "tuple[F32, F32]":
    from litrig.base.pictures import read_linear
    from processing.matcap.disc import check_disc
    from processing.matcap.matcap_exr import ENDING, read_matcap

    if path.name.lower().endswith(ENDING):
        painted = read_matcap(path)
        return painted.low.back, painted.high.back
    back = read_linear(path)
    check_disc(back, str(path))
    return back, back
