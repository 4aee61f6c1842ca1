"""`litrig ptm …`: from pictures under many lights to polynomial texture maps."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from processing.command_parts import FOLDER, JSON, PATH, check_output, echo_facts
from processing.ptm.lights.cli import lights

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from litrig.base.capture_folder.capture import Capture

_WORST_SHOWN = 3


@click.group()
def ptm() -> None:
    """Make polynomial texture maps: pictures of a still object that can be lit anew."""


ptm.add_command(lights)


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
    from processing.ptm.files.ptm_file import write_ptm
    from processing.ptm.fit import fit as fit_ptm
    from processing.ptm.quality import fit_quality
    from processing.stack import Stack

    check_output(output, ".ptm")
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
    from processing.ptm.files.ptm_file import read_ptm

    material = read_ptm(file)
    _, height, width, _ = material.coefficients.shape
    echo_facts(
        {
            "width": width,
            "height": height,
            "colour": "rgb" if material.colour is None else "lrgb",
            "space": material.space,
            "coefficients": {
                name: (round(float(term.min()), 6), round(float(term.max()), 6))
                for name, term in zip(material.basis.names, material.coefficients, strict=True)
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
    from processing.ptm.files.ptm_file import read_ptm
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
