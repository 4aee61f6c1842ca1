"""`litrig rig …`: the devices by hand."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from litrig.base.errors import InputError

if TYPE_CHECKING:
    from rig.rig import Rig

RIG = click.argument("rig_toml", metavar="RIG.toml", type=click.Path(path_type=Path))

NOTED_DEG = 0.5
"""A light this far from the direction asked for is worth a word."""


@click.group(
    epilog="Without hardware: litrig sim run examples/sim-amc.toml -- sh -c 'litrig rig move $LITRIG_RIG --angle 30'"
)
def rig() -> None:
    """Move the rig's devices by hand, one at a time.

    RIG.toml says what is plugged in where; examples/rig.toml is one to start from. Ctrl-C stops the motion at once.
    """


@contextmanager
def _opened(rig_toml: Path, *parts: str) -> Iterator["Rig"]:
    # Drivers are imported when they are needed, so that help comes at once.
    from rig.config import read_rig
    from rig.interrupts import Interrupts
    from rig.rig import open_rig

    with Interrupts(can_pause=False), open_rig(read_rig(rig_toml), use=frozenset(parts)) as opened:
        yield opened


@rig.command(epilog="Example: litrig rig home rig.toml")
@RIG
def home(rig_toml: Path) -> None:
    """Find the reference marks of everything that moves."""
    with _opened(rig_toml, "turntable", "arm", "lights") as opened:
        opened.home()
    click.echo("homed")


@rig.command(epilog="Example: litrig rig park rig.toml")
@RIG
def park(rig_toml: Path) -> None:
    """Home, move to the resting pose, lamps dark, and let go of the turntable."""
    with _opened(rig_toml, "turntable", "arm", "lights") as opened:
        opened.get_ready()
        opened.park()
    click.echo("parked")


@rig.command(epilog="Example: litrig rig move rig.toml --angle 30")
@RIG
@click.option("--angle", "angle_deg", type=float, required=True, help="Goal in degrees, counter-clockwise.")
def move(rig_toml: Path, angle_deg: float) -> None:
    """Turn the sample to an angle, and print where it stands."""
    with _opened(rig_toml, "turntable") as opened:
        opened.turntable.check(angle_deg)
        opened.turntable.home()
        pose = opened.turn_to(angle_deg)
    click.echo(f"turntable at {pose.angle_deg:.2f}°")


@rig.command(epilog="Example: litrig rig light rig.toml --azimuth 45 --elevation 30")
@RIG
@click.option("--azimuth", "azimuth_deg", type=float, help="Degrees from the picture's right towards its top.")
@click.option("--elevation", "elevation_deg", type=float, help="Degrees above the picture's plane.")
@click.option(
    "--lamp", type=click.IntRange(0), help="Number of the lamp, from 0; of a dome, no direction is needed then."
)
def light(rig_toml: Path, azimuth_deg: float | None, elevation_deg: float | None, lamp: int | None) -> None:
    """Light the sample from a direction, and print where the light comes from.

    The light arm is homed and brings its lamp there; of a dome, the nearest lamp is lit. It stays lit, on a
    GRBL output for timeout_s of [lights].
    """
    if lamp is None and (azimuth_deg is None or elevation_deg is None):
        raise click.UsageError("give --azimuth and --elevation, or --lamp of a dome")
    from litrig.base.directions import angle_between_deg, direction_from_angles

    asked = None if azimuth_deg is None or elevation_deg is None else direction_from_angles(azimuth_deg, elevation_deg)
    with _opened(rig_toml, "arm", "lights") as opened:
        if opened.has_dome:
            lamp = opened.nearest_lamp(asked) if lamp is None and asked is not None else lamp or 0
            opened.lights.check(lamp)
            pose = opened.light_from(*opened.directions_deg[lamp], lamp)
        elif azimuth_deg is None or elevation_deg is None:
            raise InputError(f"{rig_toml}: its lamps have no directions of their own; give --azimuth and --elevation")
        else:
            lamp = lamp or 0
            opened.check_light(azimuth_deg, elevation_deg, lamp)
            opened.arm.home()
            pose = opened.light_from(azimuth_deg, elevation_deg, lamp)
    off_deg = (
        0.0 if asked is None else angle_between_deg(asked, direction_from_angles(pose.azimuth_deg, pose.elevation_deg))
    )
    note = f", {off_deg:.1f}° from what was asked for" if off_deg > NOTED_DEG else ""
    click.echo(f"lamp {lamp} lit at azimuth {pose.azimuth_deg:.2f}°, elevation {pose.elevation_deg:.2f}°{note}")


@rig.command(epilog="Example: litrig rig snap rig.toml -o first.png")
@RIG
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="The picture to write.")
def snap(rig_toml: Path, output: Path) -> None:
    """Take one picture; nothing moves.

    The camera's own JPEG is kept as it is when the ending is .jpg; other endings are converted.
    """
    from litrig.base.files import write_atomically
    from litrig.base.pictures import DISPLAY_ENDINGS, JPEG_ENDINGS, decode_codes, write_codes

    ending = output.suffix.lower()
    if ending not in DISPLAY_ENDINGS:
        raise InputError(f"{output}: cannot be written as {ending or 'a file without ending'}; use .jpg, .png or .tif")
    with _opened(rig_toml, "camera") as opened:
        shot = opened.expose(opened.clock.now_s())
    if shot.ending == ending or (shot.ending in JPEG_ENDINGS and ending in JPEG_ENDINGS):
        write_atomically(output, shot.content)
    else:
        write_codes(output, decode_codes(shot.content, shot.ending, "camera"))
    click.echo(f"wrote {output}")
