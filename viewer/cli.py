"""`litrig render`: a picture of a material."""

import re
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from viewer.matcap_options import matcap_options, matcap_staging

Colour = tuple[float, float, float]

_SIDE_PX = click.IntRange(1, 8192)
_FOR_A_MESH = frozenset(
    {"projection", "yaw_deg", "pitch_deg", "roll_deg", "fov_deg", "background", "supersample", "occlusion", "tangents"}
    | {"repeat"}
)


def _background(_context: click.Context, _option: click.Parameter, value: str) -> Colour | None:
    """Read a colour as the web writes it, or none."""
    if value == "transparent":
        return None
    if not re.fullmatch(r"#[0-9a-fA-F]{6}", value):
        raise click.BadParameter(f"{value!r} is no colour; write it like #202124, or transparent")
    red, green, blue = bytes.fromhex(value[1:])
    return red / 255, green / 255, blue / 255


@click.command(
    epilog="\b\nExample: litrig render brushed.amc.ktx2 -o cloth.png --mesh cloth --pitch 25\n"
    "Example: litrig render coin.rti -o tour.mp4 --tour 90 --light 0.7 0 --specular 0.4 60"
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="IMAGE|VIDEO",
    type=click.Path(path_type=Path),
    required=True,
    help="PNG, JPEG, TIFF or EXR; MP4 with --turntable or --tour.",
)
@click.option(
    "--mesh",
    metavar="NAME|FILE",
    help="What to show it on: torus, sphere, cloth, ribbon, pillow, sewn, shirt, or a file (OBJ, PLY, GLB, STL).",
)
@click.option(
    "--light",
    "lights",
    metavar="U V",
    type=(float, float),
    multiple=True,
    help="Where a PTM's light comes from, seen from the camera: right and up, U² + V² ≤ 1; -0.4 0.4 if left out. Given "
    "again, the lights add up. An AMC has its light in it. A decomposed MatCap takes one: its light turns, so "
    "that what came from the camera comes from there.",
)
@click.option(
    "--light-colour",
    "colours",
    metavar="R G B",
    type=(float, float, float),
    multiple=True,
    help="Colour and strength of a PTM's light, as linear light: one for each --light, in their order.",
)
@click.option(
    "--softness",
    "softness_deg",
    metavar="DEG",
    type=float,
    default=0.0,
    help="Make a PTM's lights discs of this radius, seen from the object; the sun's is 0.27.",
)
@click.option(
    "--diffuse-gain",
    metavar="G",
    type=float,
    default=1.0,
    help="Scale how a PTM's shading changes with the light; 1.5 to 4 bring out relief. Of 6 terms only.",
)
@click.option(
    "--repeat",
    metavar="N",
    type=click.IntRange(1, 1000),
    default=1,
    help="Lay a PTM on the mesh N times each way; one that ptm synth --tileable made shows no seam.",
)
@click.option(
    "--specular",
    metavar="KS EXPONENT",
    type=(float, float),
    help="Add a highlight of strength KS to a PTM; the larger the exponent (10 to 200), the smaller it is.",
)
@click.option("--normals", is_flag=True, help="Show a PTM's normals: red is right, green up, blue to the camera.")
@click.option(
    "--window",
    metavar="X Y W H",
    type=(int, int, int, int),
    help="The texels of a flat PTM to show: left, top, width, height.",
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
@matcap_options
@click.option(
    "--environment",
    metavar="X.env.exr",
    type=click.Path(path_type=Path),
    help="FILE is a rendered picture with its shading buffers, and these are its surfaces' environments.",
)
@click.option(
    "--normal-map",
    metavar="N.exr",
    type=click.Path(path_type=Path),
    help="Other normals for that picture, signed, one a pixel, in the frame of its own.",
)
@click.option(
    "--recipe",
    metavar="X.recipe.toml",
    type=click.Path(path_type=Path),
    help="Steps that are done first: to that picture's shape as litrig shape recompose does them, to a decomposed "
    "MatCap as litrig matcap edit does.",
)
@click.option(
    "--kd", "diffuse_factor", metavar="K", type=float, default=1.0, help="Scale that picture's diffuse shading."
)
@click.option(
    "--kr", "reflection_factor", metavar="K", type=float, default=1.0, help="Scale that picture's reflections."
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
    "--roll", "roll_deg", metavar="DEG", type=float, default=0.0, help="Turn it about the line of sight, last of all."
)
@click.option(
    "--fov", "fov_deg", metavar="DEG", type=float, default=30.0, show_default=True, help="Field of view in perspective."
)
@click.option(
    "--zoom",
    type=float,
    default=1.0,
    show_default=True,
    help="Show it larger. Of a flat PTM, pixels a texel: from 1 up texels are squares, below their light is averaged.",
)
@click.option(
    "--background",
    metavar="COLOUR",
    callback=_background,
    default="#202124",
    show_default=True,
    help="Colour behind the object like #202124, or transparent.",
)
@click.option(
    "--exposure",
    "exposure_ev",
    metavar="STOPS",
    type=float,
    default=0.0,
    help="Make the light 2^STOPS times as strong; left out, the picture has what was measured.",
)
@click.option(
    "--tone",
    type=click.Choice(["none", "reinhard", "filmic"]),
    default="none",
    show_default=True,
    help="Bring bright light into a display's range by Reinhard's curve or a film's; none cuts it off at white.",
)
@click.option(
    "--turntable",
    "turntable_frames",
    metavar="N",
    type=int,
    help="Make a video of N frames, in which the object turns once about its upright axis.",
)
@click.option(
    "--tour",
    "tour_frames",
    metavar="N",
    type=int,
    help="Make a video of N frames, in which a PTM's lights go once round, at the height they have.",
)
@click.option("--fps", type=float, default=25.0, show_default=True, help="Frames a second of the video.")
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
    lights: tuple[tuple[float, float], ...],
    colours: tuple[tuple[float, float, float], ...],
    softness_deg: float,
    diffuse_gain: float,
    specular: tuple[float, float] | None,
    repeat: int,
    normals: bool,
    window: tuple[int, int, int, int] | None,
    directions: Path | None,
    turn_deg: float,
    unlit: Path | None,
    key: tuple[float, float] | None,
    add: Path | None,
    coordinates: str,
    occlusion: bool,
    tangents: bool,
    beside: Path | None,
    environment: Path | None,
    normal_map: Path | None,
    recipe: Path | None,
    diffuse_factor: float,
    reflection_factor: float,
    size_px: tuple[int, int] | None,
    projection: str,
    yaw_deg: float,
    pitch_deg: float,
    roll_deg: float,
    fov_deg: float,
    zoom: float,
    background: Colour | None,
    exposure_ev: float,
    tone: str,
    turntable_frames: int | None,
    tour_frames: int | None,
    fps: float,
    supersample: int,
    **for_matcaps: Any,
) -> None:
    """Draw a material into a picture or a video; neither a display nor a graphics card is needed.

    An Anisotropic MatCap (.amc.ktx2 or .amc.exr), a plain MatCap (a square picture of a ball) or a decomposed one
    (.matcap.exr) is shown on a mesh, by default a torus. A PTM or HSH (.ptm, .rti, .ptm.exr or a web folder) is relit
    flat at its own size, its values as the picture's values; with --mesh it is laid on that mesh.
    With --environment, a rendered picture with shading buffers (.exr) is shaded again under other normals.
    """
    from viewer.develop import Development, Tone
    from viewer.materials.amc import Coordinates
    from viewer.motion import Course, Motion
    from viewer.render_file import render_file
    from viewer.staging import AmcStaging, BuffersStaging, PtmStaging, Staging
    from viewer.view import Projection, View

    if turntable_frames is not None and tour_frames is not None:
        raise click.UsageError("--turntable and --tour are two videos; give one")
    fps_given = click.get_current_context().get_parameter_source("fps") is ParameterSource.COMMANDLINE
    if fps_given and turntable_frames is None and tour_frames is None:
        raise click.UsageError("--fps is the speed of a video; give --turntable or --tour too")
    motion = None
    if turntable_frames is not None:
        motion = Motion(Course.TURNTABLE, turntable_frames, fps)
    elif tour_frames is not None:
        motion = Motion(Course.TOUR, tour_frames, fps)
    view = View(Projection(projection), yaw_deg, pitch_deg, fov_deg, zoom, roll_deg)
    staging = Staging(
        *(mesh, size_px, view, background, supersample),
        amc=AmcStaging(directions, turn_deg, Coordinates(coordinates), unlit, key, add),
        ptm=PtmStaging(lights, colours, softness_deg, diffuse_gain, specular, normals, window, repeat),
        buffers=BuffersStaging(
            environment, normal_map, diffuse_factor, reflection_factor, recipe if environment else None
        ),
        matcap=matcap_staging(None if environment else recipe, **for_matcaps),
        occluded=occlusion,
        tangents=tangents,
        beside=beside,
        development=Development(exposure_ev, Tone(tone)),
        motion=motion,
        mesh_options=_given_mesh_options(),
    )
    width, height = render_file(file, output, staging)
    frames = "" if motion is None else f", {motion.frames} frames"
    click.echo(f"{output}: {width} × {height} pixels{frames}")


def _given_mesh_options() -> tuple[str, ...]:
    """Name the options that were typed and that say how a mesh is seen."""
    context = click.get_current_context()
    return tuple(
        option.opts[-1]
        for option in context.command.params
        if option.name in _FOR_A_MESH and context.get_parameter_source(option.name) is ParameterSource.COMMANDLINE
    )


@click.command(epilog="Example: litrig view brushed.amc.ktx2 --mesh cloth")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--mesh",
    metavar="NAME|FILE",
    help="What to show it on at first: torus, sphere, cloth, ribbon, pillow, sewn, shirt, or a file (OBJ, PLY, GLB, "
    "STL).",
)
@click.option("--size", "size_px", metavar="W H", type=(_SIDE_PX, _SIDE_PX), help="Pixels of the picture at first.")
@click.option(
    "--snapshots",
    metavar="DIR",
    type=click.Path(path_type=Path, file_okay=False, exists=True),
    default=Path(),
    help="Where snapshots go; the current folder if left out.",
)
def view(file: Path, mesh: str | None, size_px: tuple[int, int] | None, snapshots: Path) -> None:
    """Show a material in a window: turn it, light it, zoom, try it on other meshes.

    The object turns before a camera and under a light that stand still, for a captured table has its light in it. The
    light of a PTM, and all the light of a decomposed MatCap, follows the right mouse button. Without --mesh a PTM is
    shown flat. Snapshots are the pictures that litrig render makes.
    """
    from viewer.window.run import view_file

    view_file(file, mesh, size_px, snapshots)
