"""`litrig render`: a picture of a material."""

import re
from pathlib import Path

import click
from click.core import ParameterSource

Colour = tuple[float, float, float]

_SIDE_PX = click.IntRange(1, 8192)
_FOR_A_MESH = frozenset(
    {
        *("projection", "yaw_deg", "pitch_deg", "fov_deg", "zoom", "background", "supersample", "occlusion"),
        *("tangents", "specular", "repeat"),
    }
)


def _background(_context: click.Context, _option: click.Parameter, value: str) -> Colour | None:
    """Read a colour as the web writes it, or none."""
    if value == "transparent":
        return None
    if not re.fullmatch(r"#[0-9a-fA-F]{6}", value):
        raise click.BadParameter(f"{value!r} is no colour; write it like #202124, or transparent")
    red, green, blue = bytes.fromhex(value[1:])
    return red / 255, green / 255, blue / 255


@click.command(epilog="Example: litrig render brushed.amc.ktx2 -o cloth.png --mesh cloth --pitch 25")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", metavar="IMAGE", type=click.Path(path_type=Path), required=True, help="PNG, JPEG, TIFF or EXR."
)
@click.option(
    "--mesh",
    metavar="NAME|FILE",
    help="What to show it on: torus, sphere, cloth, ribbon, pillow, sewn, shirt, or a file (OBJ, PLY, GLB, STL).",
)
@click.option(
    "--light",
    metavar="U V",
    type=(float, float),
    help="Where a PTM's light comes from, seen from the camera: right and up, U² + V² ≤ 1; -0.4 0.4 if left out. "
    "An AMC has its light in it.",
)
@click.option(
    "--specular",
    metavar="KS EXPONENT",
    type=(click.FloatRange(0, 100), click.FloatRange(0, 10_000, min_open=True)),
    help="Add a highlight of strength KS to a PTM on a mesh, by the normals that its light tells of; the larger the "
    "exponent (10 to 200), the smaller it is.",
)
@click.option(
    "--repeat",
    metavar="N",
    type=click.IntRange(1, 1000),
    default=1,
    help="Lay a PTM on the mesh N times each way; one that ptm synth --tileable made shows no seam.",
)
@click.option(
    "--directions",
    metavar="IMAGE",
    type=click.Path(path_type=Path),
    help="Where the grain of an AMC runs on the mesh, painted as PNG or EXR: red is right, green is up, from 0 to 1; "
    "0.5 is none. Laid on by the mesh's texture coordinates.",
)
@click.option(
    "--turn",
    "turn_deg",
    metavar="DEG",
    type=float,
    default=0.0,
    help="Turn the grain of an AMC in the surface, counter-clockwise seen from outside.",
)
@click.option(
    "--unlit",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="The same AMC shot without its key light, as amc build --unlit writes it: shown where the mesh keeps the key "
    "light from itself. Needs --key.",
)
@click.option(
    "--key",
    metavar="U V",
    type=(float, float),
    help="Where the key light of --unlit stands, seen from the camera: right and up, U² + V² ≤ 1.",
)
@click.option(
    "--add",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="An AMC whose light is added: X.high.amc.ktx2 to X.low.amc.ktx2, as amc build --split writes them.",
)
@click.option(
    "--coordinates",
    type=click.Choice(["fragment", "mixed", "vertex"]),
    default="fragment",
    show_default=True,
    help="Where an AMC's coordinates are found: all at every pixel; k at the mesh's vertices; or all at the vertices.",
)
@click.option("--occlusion", is_flag=True, help="Darken by the mesh's ambient occlusion.")
@click.option("--tangents", is_flag=True, help="Draw the mesh's tangents over it as short lines.")
@click.option(
    "--beside",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Another material, drawn to the right of the first on the same mesh.",
)
@click.option("--size", "size_px", metavar="W H", type=(_SIDE_PX, _SIDE_PX), help="Pixels; 800 800 if left out.")
@click.option(
    "--projection",
    type=click.Choice(["perspective", "orthographic"]),
    default="perspective",
    show_default=True,
    help="With or without vanishing lines.",
)
@click.option(
    "--yaw", "yaw_deg", metavar="DEG", type=float, default=0.0, help="Turn the object about its upright axis."
)
@click.option(
    "--pitch",
    "pitch_deg",
    metavar="DEG",
    type=float,
    default=30.0,
    show_default=True,
    help="Tip its top to the camera.",
)
@click.option(
    "--fov", "fov_deg", metavar="DEG", type=float, default=30.0, show_default=True, help="Field of view in perspective."
)
@click.option("--zoom", type=float, default=1.0, show_default=True, help="Show it larger.")
@click.option(
    "--background",
    metavar="COLOUR",
    callback=_background,
    default="#202124",
    show_default=True,
    help="Colour behind the object like #202124, or transparent.",
)
@click.option(
    "--supersample",
    metavar="N",
    type=click.IntRange(1, 8),
    default=3,
    show_default=True,
    help="Draw N times finer and average, for smooth edges.",
)
def render(
    file: Path,
    output: Path,
    mesh: str | None,
    light: tuple[float, float] | None,
    specular: tuple[float, float] | None,
    repeat: int,
    directions: Path | None,
    turn_deg: float,
    unlit: Path | None,
    key: tuple[float, float] | None,
    add: Path | None,
    coordinates: str,
    occlusion: bool,
    tangents: bool,
    beside: Path | None,
    size_px: tuple[int, int] | None,
    projection: str,
    yaw_deg: float,
    pitch_deg: float,
    fov_deg: float,
    zoom: float,
    background: Colour | None,
    supersample: int,
) -> None:
    """Draw a material into a picture; neither a display nor a graphics card is needed.

    An Anisotropic MatCap (.amc.ktx2 or .amc.exr) or a plain MatCap (a square picture of a ball) is shown on a mesh, by
    default a torus. A PTM (.ptm, .ptm.exr or a web folder) is relit flat at its own size, its values as the picture's
    values; with --mesh it is laid on that mesh.
    """
    from viewer.materials.amc import Coordinates
    from viewer.render_file import render_file
    from viewer.staging import AmcStaging, PtmStaging, Staging
    from viewer.view import Projection, View

    view = View(Projection(projection), yaw_deg, pitch_deg, fov_deg, zoom)
    amc = AmcStaging(directions, turn_deg, Coordinates(coordinates), unlit, key, add)
    staging = Staging(
        *(mesh, light, size_px, view, background, supersample, amc, occlusion, tangents, beside),
        ptm=PtmStaging(specular, repeat),
        mesh_options=_given_mesh_options(),
    )
    width, height = render_file(file, output, staging)
    click.echo(f"{output}: {width} × {height} pixels")


def _given_mesh_options() -> tuple[str, ...]:
    """Name the options that were typed and that say how a mesh is seen."""
    context = click.get_current_context()
    return tuple(
        option.opts[-1]
        for option in context.command.params
        if option.name in _FOR_A_MESH and context.get_parameter_source(option.name) is ParameterSource.COMMANDLINE
    )
