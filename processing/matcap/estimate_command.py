"""`litrig matcap estimate`."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from processing.command_parts import JSON, PATH, FiniteRange, check_kept, check_output

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from processing.matcap.estimate.estimate import FilterEstimate, Kind
    from processing.matcap.estimate.region_estimate import RegionEstimate
    from processing.matcap.estimate.rules import Rule

Component = Literal["low", "high", "whole"]


@click.command(epilog="Example: litrig matcap estimate brass.png --roi 310 120 9 9 --plot signatures.png")
@click.argument("image", metavar="IMAGE", type=PATH)
@click.option(
    "--roi",
    "rois",
    type=int,
    nargs=4,
    metavar="X Y W H",
    multiple=True,
    help="Region around a sharp light, in pixels from the upper left corner; can be given again. By default found.",
)
@click.option(
    "--component",
    type=click.Choice(["low", "high", "whole"]),
    default="high",
    show_default=True,
    help="What is asked: the low or the high frequencies, as litrig matcap split makes them, or the picture as it is.",
)
@click.option(
    "--rule",
    type=click.Choice(["plateau", "paper"]),
    default="plateau",
    show_default=True,
    help="Which size of the window counts: where variance changes least with it, or by the paper's four cases.",
)
@click.option(
    "--of",
    type=click.Choice(["values", "edges", "auto"]),
    default="auto",
    show_default=True,
    help="What lights are taken for: points and lines (values), edges of larger ones, or whichever fits.",
)
@click.option(
    "--quantile",
    type=FiniteRange(0, 1),
    help="Which of a region's pixels counts: .5 is the median (default of plateau), 0 the least (default of paper).",
)
@click.option("--plot", "plot_path", type=PATH, metavar="PNG", help="Draw variance over the window's size.")
@JSON
def estimate(
    image: Path,
    rois: tuple[tuple[int, int, int, int], ...],
    component: Component,
    rule: "Rule",
    of: "Kind",
    quantile: float | None,
    plot_path: Path | None,
    as_json: bool,
) -> None:
    """Estimate how much a MatCap's material blurs light: its filter size ν, its slope μ(ν), its base colour.

    The sharpest light decides: its blur is taken for the material's alone. Low and high frequencies have filters of
    their own.
    """
    from litrig.base.errors import InputError
    from processing.matcap.base_colour import white_patch
    from processing.matcap.estimate.estimate import estimate_filter_size
    from processing.matcap.estimate.regions import Region

    if plot_path is not None:
        check_output(plot_path, ".png")
        check_kept([plot_path], [image])
    layer, known, clipped = _layer(image, component)
    regions = [Region(*roi) for roi in rois] or None
    try:
        found = estimate_filter_size(layer, regions, of=of, rule=rule, quantile=quantile, clipped=clipped)
    except InputError as error:
        raise InputError(f"{image}: {error}") from error
    colour = white_patch(layer, known)
    if plot_path is not None:
        from processing.matcap.estimate.plot import plot_signatures

        plot_signatures(plot_path, found)
    if as_json:
        click.echo(json.dumps(_facts(found, colour)))
        return
    for remark in found.remarks:
        click.echo(remark, err=True)
    deviation_deg = math.degrees(math.sqrt(found.filter_size))
    click.echo(f"filter size ν: {found.filter_size:.4g} rad², a standard deviation of {deviation_deg:.2f}°")
    click.echo(f"slope μ: {found.slope:.3f}")
    click.echo(f"base colour: {colour[0]:.4g} {colour[1]:.4g} {colour[2]:.4g}, linear")
    for index, region in enumerate(found.regions):
        click.echo(("* " if index == found.chosen else "  ") + _line(region))
    if plot_path is not None:
        click.echo(f"{plot_path}: signatures")


def _layer(image: Path, component: Component) -> "tuple[NDArray[np.float32], NDArray[np.bool_], NDArray[np.bool_]]":
    """Return one layer of a picture, the pixels known of it, and those that were too bright for the file."""
    import numpy as np

    from processing.matcap.disc_file import cut_off_at_white, read_disc
    from processing.matcap.separation.known import known_pixels
    from processing.matcap.separation.separate import separate

    disc = read_disc(image)
    clipped = cut_off_at_white(image, disc.colours)
    if component == "whole":
        return disc.colours, known_pixels(disc.colours, disc.covered), clipped
    layers = separate(disc.colours, covered=disc.covered, source=str(image))
    return (layers.low if component == "low" else layers.high).astype(np.float32), layers.known, clipped


def _line(region: "RegionEstimate") -> str:
    if math.isnan(region.variance):
        return f"region {region.region}, {region.of}: degenerate"
    doubt = "" if region.trusted else ", in doubt"
    return (
        f"region {region.region}, {region.of}: {region.variance:.4g} rad² ({region.least:.4g} to {region.most:.4g}), "
        f"window ± {math.degrees(region.window):.1f}°{doubt}"
    )


def _facts(found: "FilterEstimate", colour: tuple[float, float, float]) -> dict[str, Any]:
    return {
        "filter_size": found.filter_size,
        "deviation_deg": math.degrees(math.sqrt(found.filter_size)),
        "slope": found.slope,
        "base_colour": list(colour),
        "chosen": found.chosen,
        "remarks": list(found.remarks),
        "regions": [
            {
                "x": region.region.x,
                "y": region.region.y,
                "width": region.region.width,
                "height": region.region.height,
                "of": region.of,
                "variance": _number(region.variance),
                "least": _number(region.least),
                "most": _number(region.most),
                "window_deg": _number(math.degrees(region.window)),
                "trusted": region.trusted,
                "remarks": list(region.remarks),
            }
            for region in found.regions
        ],
    }


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value
