"""The options of `litrig render` that are for decomposed MatCaps."""

from collections.abc import Callable
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from processing.command_parts import FiniteRange

if TYPE_CHECKING:
    from viewer.staging import MatcapStaging

_OPTIONS = (
    click.option(
        "--low-texture",
        metavar="IMAGE",
        type=click.Path(path_type=Path),
        help="Colours that the low frequencies of a decomposed MatCap are multiplied by, laid on by the mesh's texture "
        "coordinates, as all pictures here are.",
    ),
    click.option(
        "--high-texture", metavar="IMAGE", type=click.Path(path_type=Path), help="The same for the high frequencies."
    ),
    click.option(
        "--roughness-texture",
        metavar="IMAGE",
        type=click.Path(path_type=Path),
        help="Grey: black leaves a decomposed MatCap as it is, white makes it as rough as --roughest.",
    ),
    click.option(
        "--roughest",
        "roughest_deg",
        metavar="LOW HIGH",
        type=(FiniteRange(0, 90), FiniteRange(0, 90)),
        default=(0.0, 30.0),
        show_default=True,
        help="Standard deviation of the two halves' filters in degrees where --roughness-texture is white; a half "
        "that is rougher by itself stays.",
    ),
    click.option(
        "--occlusion-map",
        metavar="IMAGE",
        type=click.Path(path_type=Path),
        help="Grey, white where nothing occludes: darkens a decomposed MatCap.",
    ),
    click.option(
        "--occlusion-of",
        type=click.Choice(["both", "low", "high"]),
        default="both",
        show_default=True,
        help="Which half of a decomposed MatCap --occlusion and --occlusion-map darken.",
    ),
    click.option(
        "--material-ids",
        metavar="IMAGE",
        type=click.Path(path_type=Path),
        help="Which MatCap is where: FILE has the darkest of its colours, each --with the next.",
    ),
    click.option(
        "--with",
        "others",
        metavar="FILE",
        type=click.Path(path_type=Path),
        multiple=True,
        help="Another decomposed MatCap for --material-ids.",
    ),
)


def matcap_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command these options; `matcap_staging` takes their values."""
    return reduce(lambda made, option: option(made), reversed(_OPTIONS), command)


def matcap_staging(
    recipe: Path | None,
    low_texture: Path | None,
    high_texture: Path | None,
    roughness_texture: Path | None,
    roughest_deg: tuple[float, float],
    occlusion_map: Path | None,
    occlusion_of: str,
    material_ids: Path | None,
    others: tuple[Path, ...],
) -> "MatcapStaging":
    from processing.matcap.variation_files import VariationFiles
    from viewer.staging import MatcapStaging

    return MatcapStaging(
        recipe,
        VariationFiles(low_texture, high_texture, roughness_texture, occlusion_map, material_ids, roughest_deg),
        others,
        (float(occlusion_of != "high"), float(occlusion_of != "low")),
    )
