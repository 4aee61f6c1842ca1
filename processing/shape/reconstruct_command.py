"""`litrig shape reconstruct`."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from processing.command_parts import JSON, PATH, FiniteRange, check_kept, check_output, echo_facts
from processing.shape.buffers_options import buffers_options, say

if TYPE_CHECKING:
    from processing.shape.buffers_exr import ReadOptions


@click.command(epilog="Example: litrig shape reconstruct shot.exr -o shot.env.exr --report shot.png")
@click.argument("file", metavar="BUFFERS.exr", type=PATH)
@click.option("-o", "--output", metavar="X.env.exr", type=PATH, required=True, help="The environments to write.")
@click.option(
    "--surface",
    "surfaces",
    metavar="ID",
    type=click.IntRange(1),
    multiple=True,
    help="Only this surface; can be given again. All that are seen if left out.",
)
@click.option(
    "--size",
    type=click.IntRange(2, 4096),
    default=512,
    show_default=True,
    help="Texels along a side of each half of the reflection environment.",
)
@click.option(
    "--diffuse",
    "method",
    type=click.Choice(["qp", "ls"]),
    default="qp",
    show_default=True,
    help="qp: as close to the shading as can be and under none of it, so that what occlusion took stays apart. "
    "ls: least squares.",
)
@click.option(
    "--ridge",
    type=FiniteRange(0),
    default=0.0,
    show_default=True,
    help="Keeps diffuse light small where no normal tells of it, at the cost of a closer fit; 1e-3 or so for surfaces "
    "that are nearly flat.",
)
@click.option("--never-negative", is_flag=True, help="Let the diffuse light be negative in no direction.")
@click.option(
    "--hot-pixels",
    metavar="FACTOR",
    type=FiniteRange(1, min_open=True),
    help="Leave out pixels whose diffuse shading is this many times as bright as all around them but two.",
)
@click.option(
    "--regions",
    type=click.IntRange(1, 64),
    default=1,
    show_default=True,
    help="Divide each surface into so many parts with light of their own; for surfaces so extended that it is not the "
    "same everywhere.",
)
@click.option(
    "--interpolation",
    type=click.Choice(["triangles", "quads"]),
    default="triangles",
    show_default=True,
    help="Between four pixels' reflections: two triangles, or mean value coordinates in the quad, which cost more.",
)
@click.option(
    "--occlusion-threshold",
    type=FiniteRange(0, 1),
    default=0.5,
    show_default=True,
    help="Reflections of pixels that are less open count for nothing.",
)
@click.option(
    "--normal-jump",
    "normal_jump_deg",
    metavar="DEG",
    type=FiniteRange(0, 180, min_open=True),
    default=30.0,
    show_default=True,
    help="Angle between the normals of neighbouring pixels at which a smooth patch ends.",
)
@click.option(
    "--depth-jump",
    metavar="FACTOR",
    type=FiniteRange(0, min_open=True),
    default=3.0,
    show_default=True,
    help="Step in depth at which it ends, in multiples of what the surface's slant explains.",
)
@click.option(
    "--blur",
    "blur_deg",
    metavar="DEG",
    type=FiniteRange(0, 90),
    default=0.5,
    show_default=True,
    help="Blur of the reflection environment where patches meet; 0 leaves the breaks.",
)
@click.option(
    "--report",
    "sheet",
    metavar="IMAGE",
    type=PATH,
    help="Write a picture with a row a surface: Gauss map, diffuse environment, residuals, reflections seen, "
    "reflection environment, both.",
)
@buffers_options
@JSON
def reconstruct(
    file: Path,
    output: Path,
    surfaces: tuple[int, ...],
    size: int,
    method: Literal["qp", "ls"],
    ridge: float,
    never_negative: bool,
    hot_pixels: float | None,
    regions: int,
    interpolation: Literal["triangles", "quads"],
    occlusion_threshold: float,
    normal_jump_deg: float,
    depth_jump: float,
    blur_deg: float,
    sheet: Path | None,
    read_options: "Callable[[], ReadOptions]",
    as_json: bool,
) -> None:
    """Find the light of all directions that the surfaces of a rendered picture show, each for itself.

    BUFFERS.exr holds the picture and its shading buffers. Diffuse light is kept as nine harmonics, reflected light as a
    dual paraboloid map; both are already filtered by the surface's material, or, where the buffers have an albedo, are
    the light before it. They are what `litrig shape recompose` shades edited normals with.
    """
    import hashlib

    from litrig.base.console import reporting
    from litrig.base.pictures import DISPLAY_ENDINGS, write_codes
    from processing.shape.buffers_exr import read_buffers
    from processing.shape.diffuse.fit import DiffuseOptions
    from processing.shape.env_exr import ENDING, check_room, write_environments
    from processing.shape.reconstruct import ReconstructOptions
    from processing.shape.reconstruct import reconstruct as reconstruct_from
    from processing.shape.reconstruction_sheet import reconstruction_sheet
    from processing.shape.reflection.environment import ReflectionOptions
    from processing.shape.reflection.polygons import Smoothness

    check_output(output, ENDING)
    if sheet is not None:
        check_output(sheet, *DISPLAY_ENDINGS)
    check_kept([output, sheet], [file])
    options = ReconstructOptions(
        DiffuseOptions(method, ridge, never_negative),
        ReflectionOptions(size, interpolation, occlusion_threshold, Smoothness(normal_jump_deg, depth_jump), blur_deg),
        hot_pixels,
        regions,
    )
    buffers = read_buffers(file, read_options(), say)
    check_room(output, len(set(surfaces) or buffers.seen), regions, size)
    with reporting() as report:
        found = reconstruct_from(buffers, surfaces or None, options, report)
    with file.open("rb") as content:
        source = hashlib.file_digest(content, "sha256").hexdigest()
    write_environments(output, found.environments, source)
    if sheet is not None:
        write_codes(sheet, reconstruction_sheet(buffers, found))
    for remark in found.remarks:
        say(remark)
    shown = {str(number): round(share, 4) for number, share in found.coverage.items()}
    if as_json:
        echo_facts({"surfaces": list(found.environments), "coverage": shown, "remarks": list(found.remarks)}, as_json)
    else:
        told = ", ".join(
            f"surface {number} shows {share:.0%} of all reflected directions"
            for number, share in found.coverage.items()
        )
        click.echo(f"{output}: {len(found.environments)} environments; {told}")
