"""`litrig ptm …`: from pictures under many lights to polynomial texture maps."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from processing.command_parts import FOLDER, JSON, PATH, references
from processing.ptm.files.cli import convert, info
from processing.ptm.lights.cli import lights
from processing.ptm.relighting.cli import relight
from processing.ptm.synthesis.cli import synth

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from litrig.base.capture_folder.capture import Capture
    from processing.command_parts import Refer
    from processing.ptm.basis import Basis, Kind
    from processing.ptm.model import Colour, Space
    from processing.ptm.near_lights import NearLights
    from processing.ptm.robust import Robust


@click.group()
def ptm() -> None:
    """Make polynomial texture maps: pictures of a still object that can be lit anew."""


ptm.add_command(info)
ptm.add_command(convert)
ptm.add_command(relight)
ptm.add_command(lights)
ptm.add_command(synth)


@ptm.command(epilog="Example: litrig ptm fit coin-session -o coin.ptm")
@FOLDER
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    type=PATH,
    required=True,
    help="What to write: .ptm, .rti (of hsh), .ptm.exr (floats), or a name without ending for a web folder.",
)
@click.option("--lp", type=PATH, metavar="FILE", help="Light directions, .lp or .dome; by default those of the folder.")
@click.option(
    "--basis",
    type=click.Choice(["ptm", "hsh"]),
    default="ptm",
    show_default=True,
    help="ptm: polynomials of the light's direction. hsh: hemispherical harmonics, sharper, from more lights.",
)
@click.option("--terms", type=int, metavar="N", help="6 or 3 of ptm; 9, 4 or 16 of hsh. The first is the default.")
@click.option(
    "--colour",
    type=click.Choice(["lrgb", "rgb"]),
    help="lrgb: coefficients of luminance and a fixed colour a pixel. rgb: coefficients a channel. By default lrgb for "
    "ptm, rgb for hsh.",
)
@click.option(
    "--space",
    type=click.Choice(["srgb", "linear"]),
    default="srgb",
    show_default=True,
    help="Fit display values, as other tools expect, or linear light.",
)
@click.option(
    "--robust",
    type=click.Choice(["no", "trimmed", "reweighted"]),
    default="no",
    show_default=True,
    help="Hold back shadows and highlights: leave out a pixel's darkest and brightest pictures, or lower the weight of "
    "those that do not fit.",
)
@click.option(
    "--ridge",
    type=click.FloatRange(0, 10),
    default=0.0,
    metavar="R",
    help="Hold down large coefficients, for few lights.",
)
@click.option(
    "--picture-width",
    type=float,
    metavar="MM",
    help="How much the picture's width shows; with light positions, makes light directions and brightness differ over "
    "the picture. A .dome may say it.",
)
@click.option("--far", is_flag=True, help="Take lights for distant also where their positions are known.")
@click.option(
    "--memory",
    type=click.FloatRange(0.05, 10_000),
    default=1.0,
    show_default=True,
    metavar="GB",
    help="Decoded pictures of more than this go to a temporary file.",
)
@click.option("--spool", type=PATH, metavar="DIR", help="Where that file goes; by default where temporary files go.")
@click.option("--angle", "angle_deg", type=float, metavar="DEG", help="Of a session of many angles, the one to fit.")
@references
@JSON
def fit(  # one option each
    folder: Path,
    output: Path,
    lp: Path | None,
    basis: "Kind",
    terms: int | None,
    colour: "Colour | None",
    space: "Space",
    robust: "Robust",
    ridge: float,
    picture_width: float | None,
    far: bool,
    memory: float,
    spool: Path | None,
    angle_deg: float | None,
    refer: "Refer",
    as_json: bool,
) -> None:
    """Fit a relightable picture to the pictures in FOLDER.

    FOLDER is a capture folder, or holds pictures and an .lp file with a line `name x y z` for each: the direction from
    the object to the light, x to the right, y up, z to the camera.

    Each picture is also predicted from all others: where that fails, the light's direction is wrong, or nothing near it
    was shot.
    """
    from litrig.base.console import reporting
    from processing.ptm.files.either import check_form, choose_coder, write_any
    from processing.ptm.fit import FitSettings, start_fit
    from processing.ptm.quality import report_on
    from processing.stack import Stack

    chosen = _basis(basis, terms)
    check_form(output, chosen)
    capture, lights = _read_lit_frames(folder, lp, picture_width, angle_deg)
    settings = FitSettings(
        basis=chosen,
        colour=colour or ("lrgb" if basis == "ptm" else "rgb"),
        space=space,
        robust=robust,
        ridge=ridge,
        near=None if far else lights.near,
        light_gains=lights.gains,
        memory_bytes=int(memory * 1e9),
        spool=spool,
    )
    stack = Stack.of(refer(capture))
    names = {"source": capture.digest, "lights_source": str(capture.lights_from or folder)}
    with reporting() as report:
        fitted = start_fit(stack, lights.directions, settings, report=report, **names)
        coder = choose_coder(output, fitted)
        worth = report_on(fitted, None if coder is None else coder.stored)
        write_any(output, fitted, coder, report)
    pictures = [path.name for path in stack.paths]
    if as_json:
        click.echo(json.dumps(worth.facts(pictures)))
        return
    click.echo("\n".join(worth.lines(pictures)))
    near = "" if settings.near is None else ", near lights"
    click.echo(f"{output}: {stack.shape[1]} × {stack.shape[0]} pixels, {chosen}, {settings.colour}, {space}{near}")


class _Lit(NamedTuple):
    """The lights of the frames: `directions` (N, 3), `gains` (N, 3) or None, and where they stood if that is known."""

    directions: "NDArray[np.float64]"
    gains: "NDArray[np.float64] | None"
    near: "NearLights | None"


def _basis(kind: "Kind", terms: int | None) -> "Basis":
    from processing.ptm.basis import TERMS, Basis

    possible = TERMS[kind]
    if terms is not None and terms not in possible:
        raise click.BadParameter(f"{kind} has {' or '.join(map(str, possible))}", param_hint="--terms")
    return Basis(kind, terms or possible[0])


def _read_lit_frames(
    folder: Path, lp: Path | None, picture_width_mm: float | None, angle_deg: float | None
) -> "tuple[Capture, _Lit]":
    import numpy as np

    from litrig.base.capture_folder.capture import Role
    from litrig.base.capture_folder.reader import pair_lights, read_capture
    from litrig.base.capture_folder.select import at_one_angle
    from litrig.base.errors import InputError
    from litrig.base.light_files import read_lights
    from processing.ptm.near_lights import NearLights

    capture = read_capture(folder)
    if lp is not None:
        listed = read_lights(lp)
        if picture_width_mm is not None and listed.positions_mm is None:
            # The vectors of an .lp are positions where they are not of length 1, and the width says in what unit.
            listed = replace(listed, positions_mm=listed.vectors)
        capture = pair_lights(capture, listed, lp)
    for frame in capture.having(Role.FRAME):
        if frame.light is None:
            raise InputError(f"{frame.path}: its light is not known; put an .lp file beside it, or name one with --lp")
    capture = at_one_angle(capture, angle_deg)
    frames = list(capture.having(Role.FRAME))
    for remark in capture.remarks:
        click.echo(remark, err=True)
    positions = [frame.light_position_mm for frame in frames if frame.light_position_mm is not None]
    gains = [frame.light_gain for frame in frames if frame.light_gain is not None]
    width_mm = picture_width_mm or capture.picture_width_mm
    if picture_width_mm is not None and len(positions) < len(frames):
        raise InputError(
            f"{folder}: where its lights stood is not known, only their directions; leave --picture-width out, or name "
            "a .dome, or an .lp of positions, with --lp"
        )
    near = None
    if width_mm is not None and len(positions) == len(frames):
        near = NearLights(np.array(positions), width_mm)
    directions = np.array([frame.light for frame in frames])
    return capture, _Lit(directions, np.array(gains) if len(gains) == len(frames) else None, near)
