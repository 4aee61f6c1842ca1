"""Arguments and options that several commands of the rig share."""

from pathlib import Path

import click

RIG = click.argument("rig_toml", metavar="RIG.toml", type=click.Path(path_type=Path))


def _record(context: click.Context, _: click.Parameter, path: Path | None) -> None:
    if path is not None:
        from rig.wire_record import recording

        context.with_resource(recording(path))


RECORD = click.option(
    "--record",
    metavar="FILE",
    type=click.Path(path_type=Path),
    callback=_record,
    expose_value=False,
    help="Append every byte on the serial ports to FILE, with its time.",
)
"""For every command that opens ports; it records by itself, until the command has ended."""
