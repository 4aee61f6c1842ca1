"""`litrig amc …` and `litrig ptm …`: from captured pictures to materials."""

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from litrig.base.capture_folder.capture import Capture
    from processing.amc.build import AmcResult
    from processing.amc.model import Invariance

PATH = click.Path(path_type=Path)
FOLDER = click.argument("folder", metavar="FOLDER", type=PATH)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object, for programs.")
_WORST_SHOWN = 3


def _parse_invariance(_context: click.Context, _option: click.Parameter, word: str) -> "str | int":
    if word in ("auto", "isotropic"):
        return word
    if not re.fullmatch("[0-9]{1,3}", word):
        raise click.BadParameter(f"{word!r} is neither auto, isotropic nor a whole number of up to three digits")
    return int(word)


@click.group()
def amc() -> None:
    """Make Anisotropic MatCaps: the look of a material in one lighting, from a turn of a covered sphere."""


@amc.command(epilog="Example: litrig amc build brushed-session -o brushed.amc.ktx2")
@FOLDER
@click.option("-o", "--output", metavar="X.amc.ktx2", type=PATH, required=True, help="The file to write.")
@click.option("--size", type=int, default=128, show_default=True, help="Texels along each side of a slice.")
@click.option("--depth", type=int, metavar="D", help="Slices to store; by default the captured ones divided by R.")
@click.option(
    "--invariance",
    metavar="auto|isotropic|N",
    callback=_parse_invariance,
    default="auto",
    show_default=True,
    help="How often the material repeats in a turn, R: most cloth and brushed metal do twice. auto finds it.",
)
@click.option(
    "--threshold", type=float, metavar="T", help="For auto: the share of change, 0..1, that may contradict an R. [0.05]"
)
@click.option(
    "--circle", type=float, nargs=3, metavar="X Y R", help="The sphere's outline in pixels, from the upper left corner."
)
@click.option("--distance", type=float, metavar="RADII", help="Camera to the sphere's centre, in radii of the sphere.")
@click.option(
    "--camera", type=PATH, metavar="CAMERA.toml", help="Calibrated camera: gives the distance, takes out distortion."
)
@click.option(
    "--normal",
    type=click.Choice(["rectified", "view", "camera"]),
    default="rectified",
    show_default=True,
    help="How a normal seen along an oblique ray is brought to the table; matters in perspective alone.",
)
@click.option(
    "--tangent-zero",
    type=float,
    metavar="DEG",
    help="Direction of brushing or thread at turntable zero; by default what the session says.",
)
def build(
    folder: Path,
    output: Path,
    size: int,
    depth: int | None,
    invariance: 'Literal["auto"] | Invariance',
    threshold: float | None,
    circle: tuple[float, float, float] | None,
    distance: float | None,
    camera: Path | None,
    normal: str,
    tangent_zero: float | None,
) -> None:
    """Build an Anisotropic MatCap from FOLDER.

    FOLDER is a capture folder, or holds pictures and an angles.csv with a line `name,deg` for each. The sphere is
    found by itself; what was found is printed.
    """
    from litrig.base.camera_model import read_camera_model
    from litrig.base.capture_folder.reader import read_capture
    from litrig.base.console import reporting
    from litrig.base.table_normals import TableNormal
    from processing.amc.build import build as build_amc
    from processing.amc.circle import Circle
    from processing.amc.invariance import THRESHOLD
    from processing.amc.ktx2 import write_amc

    if distance is not None and camera is not None:
        raise click.UsageError("--distance and --camera both say how far the camera stands; give one")
    _check_output(output, ".amc.ktx2")
    with reporting() as report:
        result = build_amc(
            read_capture(folder),
            size=size,
            depth=depth,
            invariance=invariance,
            threshold=THRESHOLD if threshold is None else threshold,
            circle=None if circle is None else Circle(*circle),
            distance_radii=distance,
            camera=None if camera is None else read_camera_model(camera),
            table_normal=TableNormal(normal),
            tangent_zero_deg=tangent_zero,
            report=report,
        )
        write_amc(output, result.amc)
    _echo_build(result)
    _, height, width, _ = result.amc.slices.shape
    click.echo(f"{output}: {len(result.amc.slices)} slices of {width} × {height}")


@amc.command(name="info", epilog="Example: litrig amc info brushed.amc.ktx2 --json")
@click.argument("file", metavar="X.amc.ktx2", type=PATH)
@JSON
def amc_info(file: Path, as_json: bool) -> None:
    """Say what an Anisotropic MatCap file holds and what it was made from."""
    from processing.amc.ktx2 import read_header

    header = read_header(file)
    _echo_info(
        {
            "size": header.size,
            "depth": header.depth,
            "invariance": header.invariance,
            "table_normal": str(header.table_normal),
            "captured_slices": len(header.slice_angles_deg),
            "mip_levels": header.levels,
            "texels": "half float, linear" if header.half_float else "8 bits, sRGB",
            "compressed": header.compressed,
            "source": header.source,
            "written_by": f"litrig {header.written_by}",
        },
        as_json,
    )


@click.group()
def ptm() -> None:
    """Make polynomial texture maps: pictures of a still object that can be lit anew."""


@ptm.command(epilog="Example: litrig ptm fit coin-session -o coin.ptm")
@FOLDER
@click.option("-o", "--output", metavar="OUT.ptm", type=PATH, required=True, help="The file to write.")
@click.option("--lp", type=PATH, metavar="X.lp", help="Light directions; by default those of the folder.")
@click.option(
    "--colour",
    type=click.Choice(["lrgb", "rgb"]),
    default="lrgb",
    show_default=True,
    help="lrgb: a polynomial of luminance and a fixed colour a pixel. rgb: a polynomial a channel.",
)
@click.option(
    "--space",
    type=click.Choice(["srgb", "linear"]),
    default="srgb",
    show_default=True,
    help="Fit display values, as other tools expect, or linear light.",
)
def fit(
    folder: Path, output: Path, lp: Path | None, colour: Literal["lrgb", "rgb"], space: Literal["srgb", "linear"]
) -> None:
    """Fit a polynomial texture map to the pictures in FOLDER.

    FOLDER is a capture folder, or holds pictures and an .lp file with a line `name x y z` for each: the direction from
    the object to the light, x to the right, y up, z to the camera.
    """
    from litrig.base.console import reporting
    from processing.ptm.fit import fit as fit_ptm
    from processing.ptm.ptm_file import write_ptm
    from processing.ptm.quality import fit_quality
    from processing.stack import Stack

    _check_output(output, ".ptm")
    capture, light_dirs = _read_lit_frames(folder, lp)
    stack = Stack.of(capture)
    with reporting() as report:
        result = fit_ptm(stack, light_dirs, colour=colour, space=space, source=capture.digest, report=report)
        quality = fit_quality(result, stack, light_dirs, report)
        write_ptm(output, result)
    worst = [f"{stack.paths[index].name} {quality.per_light_db[index]:.1f} dB" for index in quality.worst(_WORST_SHOWN)]
    click.echo(f"fit: {quality.psnr_db:.1f} dB over {len(stack)} pictures; worst {', '.join(worst)}")
    click.echo(f"{output}: {stack.shape[1]} × {stack.shape[0]} pixels, {colour.upper()}, {space} values")


@ptm.command(name="info", epilog="Example: litrig ptm info coin.ptm --json")
@click.argument("file", metavar="X.ptm", type=PATH)
@JSON
def ptm_info(file: Path, as_json: bool) -> None:
    """Say what a polynomial texture map holds."""
    from processing.ptm.ptm_file import read_ptm

    material = read_ptm(file)
    _, height, width, _ = material.coefficients.shape
    names = ("u2", "v2", "uv", "u", "v", "1")
    _echo_info(
        {
            "width": width,
            "height": height,
            "colour": "rgb" if material.colour is None else "lrgb",
            "space": material.space,
            "coefficients": {
                name: (round(float(term.min()), 6), round(float(term.max()), 6))
                for name, term in zip(names, material.coefficients, strict=True)
            },
            "source": material.source,
        },
        as_json,
    )


@ptm.command(epilog="Example: litrig ptm relight coin.ptm --light 0.7 0.2 -o raking.png")
@click.argument("file", metavar="X.ptm", type=PATH)
@click.option(
    "--light", type=float, nargs=2, metavar="U V", required=True, help="Light direction: to the right and up, -1..1."
)
@click.option("-o", "--output", metavar="IMAGE", type=PATH, required=True, help="PNG, JPEG, TIFF or EXR to write.")
def relight(file: Path, light: tuple[float, float], output: Path) -> None:
    """Make the picture of a polynomial texture map under a light.

    The file's values become the picture's values as they are; an EXR gets linear light.
    """
    import numpy as np

    from litrig.base.errors import InputError
    from litrig.base.pictures import write_codes, write_picture
    from litrig.base.radiometry import decode_srgb, to_u8
    from processing.ptm.ptm_file import read_ptm
    from processing.ptm.relight import relight as evaluate

    if not light[0] ** 2 + light[1] ** 2 <= 1:
        raise InputError(f"a light at {light[0]:g}, {light[1]:g} is below the horizon; u² + v² must not exceed 1")
    material = read_ptm(file)
    values = evaluate(material, np.array(light))
    if output.suffix.lower() == ".exr":
        write_picture(output, decode_srgb(values) if material.space == "srgb" else values)
    else:
        write_codes(output, to_u8(values))
    click.echo(f"{output}: {values.shape[1]} × {values.shape[0]} pixels")


def _check_output(output: Path, ending: str) -> None:
    """Refuse before the work what could not be written after it."""
    from litrig.base.errors import InputError

    if not output.name.lower().endswith(ending):
        raise InputError(
            f"{output}: cannot be written as {output.suffix or 'a name without ending'}; end it in {ending}"
        )
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist; create it first")


def _read_lit_frames(folder: Path, lp: Path | None) -> "tuple[Capture, NDArray[np.float64]]":
    import numpy as np

    from litrig.base.capture_folder.capture import Role
    from litrig.base.capture_folder.reader import pair_lights, read_capture
    from litrig.base.errors import InputError
    from litrig.base.lp import read_lp

    capture = read_capture(folder)
    if lp is not None:
        capture = pair_lights(capture, read_lp(lp), lp)
    lights = []
    for frame in capture.having(Role.FRAME):
        if frame.light is None:
            raise InputError(f"{frame.path}: its light is not known; put an .lp file beside it, or name one with --lp")
        lights.append(frame.light)
    return capture, np.array(lights)


def _echo_build(result: "AmcResult") -> None:
    found = result.invariance
    away = "orthographic" if result.distance_radii is None else f"camera at {result.distance_radii:.2f} radii"
    click.echo(f"sphere: {result.circle}; {away}")
    click.echo(f"change over the turn: {found.variation:.1%} of the mean light, noise {found.noise:.1e} a harmonic")
    for entry in found.evidence[1:]:
        click.echo(
            f"  R = {entry.repeats}: {entry.outside_plane:.1%} of the change contradicts it; "
            f"folding the table loses {entry.outside_k:.1%}"
        )
    said = "isotropic" if result.amc.invariance == "isotropic" else f"R = {result.amc.invariance}"
    prescribed = "" if result.amc.invariance == found.found else f", as asked for (found: {found.found})"
    click.echo(f"{said}{prescribed}")


def _echo_info(facts: dict[str, Any], as_json: bool) -> None:
    if as_json:
        click.echo(json.dumps(facts))
        return
    for key, value in facts.items():
        if isinstance(value, dict):
            click.echo(f"{key.replace('_', ' ')}:")
            for name, (least, most) in value.items():
                click.echo(f"  {name}: {least:g} to {most:g}")
        else:
            click.echo(f"{key.replace('_', ' ')}: {value}")
