"""`litrig ptm relight`."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from processing.command_parts import PATH, PICTURES, Finite, FiniteRange, check_output, echo_clipped

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from processing.ptm.model import Ptm
    from processing.ptm.relighting.lights import Lights

_UNSHARP_RADIUS_PX = 2.0
_POSITIVE, _NOT_NEGATIVE = FiniteRange(0, min_open=True), FiniteRange(0)


@click.command(epilog="Example: litrig ptm relight coin.ptm --light 0.7 0.2 --specular 0.4 60 -o raking.png")
@click.argument("file", metavar="X.ptm", type=PATH)
@click.option(
    "--light",
    "positions",
    type=float,
    nargs=2,
    metavar="U V",
    multiple=True,
    help="Light direction: to the right and up, -1..1. Given again, the lights add up.",
)
@click.option(
    "--light-colour",
    "colours",
    type=_NOT_NEGATIVE,
    nargs=3,
    metavar="R G B",
    multiple=True,
    help="Colour and strength of a light, as linear light: one for each --light, in their order.",
)
@click.option(
    "--environment",
    metavar="IMAGE",
    type=PATH,
    help="Light from all sides: a panorama in latitude and longitude (EXR, HDR, PNG …), its centre behind the camera.",
)
@click.option("--rotate", "rotate_deg", type=Finite(), metavar="DEG", help="Turn the environment about the vertical.")
@click.option(
    "--exposure", "exposure_ev", type=FiniteRange(-30, 30), metavar="EV", help="Make the light 2^EV times as strong."
)
@click.option(
    "--diffuse-gain",
    type=_NOT_NEGATIVE,
    metavar="G",
    help="Scale how shading changes with the light; 1.5 to 4 bring out relief under a high light. PTM of 6 terms only.",
)
@click.option(
    "--unsharp", type=_NOT_NEGATIVE, metavar="GAIN", help="Sharpen, by this many times the difference to a blur."
)
@click.option(
    "--unsharp-radius",
    "radius_px",
    type=_POSITIVE,
    metavar="PX",
    help=f"Standard deviation of that blur; {_UNSHARP_RADIUS_PX:g} if left out.",
)
@click.option(
    "--specular",
    type=(_NOT_NEGATIVE, _POSITIVE),
    metavar="KS EXPONENT",
    help="Add a highlight of strength KS; the larger the exponent (10 to 200), the smaller it is.",
)
@click.option(
    "--diffuse-weight",
    type=_NOT_NEGATIVE,
    metavar="KD",
    help="Weight of the material's own values, to make room for the highlight; 1 if left out.",
)
@click.option("-o", "--output", metavar="IMAGE", type=PATH, required=True, help="PNG, JPEG, TIFF or EXR to write.")
def relight(
    file: Path,
    positions: tuple[tuple[float, float], ...],
    colours: tuple[tuple[float, float, float], ...],
    environment: Path | None,
    rotate_deg: float | None,
    exposure_ev: float | None,
    diffuse_gain: float | None,
    unsharp: float | None,
    radius_px: float | None,
    specular: tuple[float, float] | None,
    diffuse_weight: float | None,
    output: Path,
) -> None:
    """Make the picture of a polynomial texture map under a light, several, or an environment.

    The picture has values of the file's own kind, display values or linear light; an EXR gets linear light in any case.
    Light of several lights adds up in linear light.
    """
    from litrig.base.console import reporting
    from litrig.base.radiometry import decode_srgb, encode_srgb
    from processing.ptm.relighting.highlight import Highlight, shade
    from processing.ptm.relighting.many_lights import relight_by_many
    from processing.ptm.relighting.normals import normals_of

    _check_use(positions, colours, environment, rotate_deg, unsharp, radius_px)
    check_output(output, *PICTURES)
    lights = _lights(positions, colours, environment, rotate_deg or 0.0)
    fitted = _read(file)
    highlight = None if specular is None else Highlight(normals_of(fitted), *specular)
    material = _processed(file, fitted, diffuse_gain, unsharp, radius_px or _UNSHARP_RADIUS_PX, diffuse_weight)
    is_light = material.space == "linear"
    if len(positions) == 1 and not colours and environment is None and exposure_ev is None:
        values = shade(material, lights.directions[0], highlight)
        picture = values if is_light or not _holds_light(output) else decode_srgb(values)
    else:
        with reporting() as report:
            light = relight_by_many(material, lights.exposed(exposure_ev or 0.0), highlight, report)
        echo_clipped(output, light)
        picture = light if is_light or _holds_light(output) else encode_srgb(light)
    _write(output, picture)
    click.echo(f"{output}: {picture.shape[1]} × {picture.shape[0]} pixels")


def _check_use(
    positions: tuple[tuple[float, float], ...],
    colours: tuple[tuple[float, float, float], ...],
    environment: Path | None,
    rotate_deg: float | None,
    unsharp: float | None,
    radius_px: float | None,
) -> None:
    if not positions and environment is None:
        raise click.UsageError("name a light: --light U V, or --environment IMAGE")
    if colours and len(colours) != len(positions):
        raise click.UsageError(f"{len(positions)} --light but {len(colours)} --light-colour; give one for each")
    if rotate_deg is not None and environment is None:
        raise click.UsageError("--rotate turns an environment; name one with --environment")
    if radius_px is not None and unsharp is None:
        raise click.UsageError("--unsharp-radius is the radius of --unsharp; give that too")


def _lights(
    positions: tuple[tuple[float, float], ...],
    colours: tuple[tuple[float, float, float], ...],
    environment: Path | None,
    rotate_deg: float,
) -> "Lights":
    from litrig.base.errors import InputError
    from litrig.base.pictures import read_linear
    from processing.ptm.relighting.environment import environment_lights
    from processing.ptm.relighting.lights import lamps

    for u, v in positions:
        if not u**2 + v**2 <= 1:
            raise InputError(f"a light at {u:g}, {v:g} is below the horizon; u² + v² must not exceed 1")
    lights = lamps(positions, colours)
    if environment is None:
        return lights
    return lights.and_also(environment_lights(read_linear(environment), rotate_deg, str(environment)))


def _read(file: Path) -> "Ptm":
    from processing.ptm.files.either import read_any

    return read_any(file)


def _processed(
    file: Path,
    material: "Ptm",
    diffuse_gain: float | None,
    unsharp: float | None,
    radius_px: float,
    diffuse_weight: float | None,
) -> "Ptm":
    """Apply what changes the coefficients."""
    from dataclasses import replace

    import numpy as np

    from processing.ptm.relighting.diffuse_gain import gain_diffuse
    from processing.ptm.relighting.unsharp import sharpen

    if diffuse_gain is not None:
        material = gain_diffuse(material, diffuse_gain, str(file))
    if unsharp is not None:
        material = sharpen(material, unsharp, radius_px)
    if diffuse_weight is not None:
        material = replace(material, coefficients=material.coefficients * np.float32(diffuse_weight))
    return material


def _holds_light(output: Path) -> bool:
    return output.suffix.lower() == ".exr"


def _write(output: Path, picture: "NDArray[np.float32]") -> None:
    from litrig.base.pictures import write_codes, write_picture
    from litrig.base.radiometry import to_u8

    if _holds_light(output):
        write_picture(output, picture)
    else:
        write_codes(output, to_u8(picture))
