"""`litrig rig init`."""

from pathlib import Path

import click

from rig.options import RECORD


@click.command(epilog="Example: litrig rig init -o rig.toml")
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="The RIG.toml to write.")
@click.option(
    "--port",
    "ports",
    metavar="PATH",
    multiple=True,
    help="A serial port to ask; may be repeated. By default all USB ports.",
)
@click.option(
    "--camera",
    "cameras",
    metavar="PATH",
    multiple=True,
    help="A camera to try; may be repeated. By default all of /dev/video*.",
)
@click.option("--force", is_flag=True, help="Write over a file that is there.")
@RECORD
def init(output: Path, ports: tuple[str, ...], cameras: tuple[str, ...], force: bool) -> None:
    """Write a commented RIG.toml from what is plugged in; nothing moves.

    Serial ports are asked for a GRBL controller and for Dynamixel servos at their usual baud rates; cameras are tried
    by taking a picture.
    """
    from litrig.base.errors import InputError
    from litrig.base.files import write_atomically
    from rig.init.discovery import camera_devices, discover, serial_ports
    from rig.init.rig_toml import write_rig_toml

    if output.exists() and not force:
        raise InputError(f"{output}: is there already; name another file, or write over it with --force")
    if not output.absolute().parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist; create it first")
    found = discover(dict.fromkeys(ports or serial_ports()), dict.fromkeys(cameras or camera_devices()))
    write_atomically(output, write_rig_toml(found).encode())
    for servos in found.servos:
        click.echo(f"{servos.port}: servo {', '.join(map(str, servos.models))} at {servos.baud} baud")
    for controller in found.controllers:
        click.echo(f"{controller.port}: GRBL {controller.version or 'controller'}")
    for camera in found.cameras:
        click.echo(f"{camera.config.device}: camera, {camera.config.width} × {camera.config.height}")
    for silent in found.silent:
        click.echo(f"litrig: {silent.path}: {silent.reason}", err=True)
    click.echo(f"wrote {output}; look through it, then: litrig rig doctor {output}")
