"""`litrig ptm convert|info`: the forms in which a material is kept."""

from pathlib import Path

import click

from processing.command_parts import JSON, PATH, echo_facts


@click.command(name="info", epilog="Example: litrig ptm info coin.ptm --json")
@click.argument("file", metavar="X", type=PATH)
@JSON
def info(file: Path, as_json: bool) -> None:
    """Say what a material holds: .ptm, .rti, .ptm.exr, or a web folder.

    Coefficients are said as far as their codes reach, in units where 1 is white.
    """
    from processing.ptm.files.either import describe

    facts = describe(file)
    if "coefficients" in facts:
        ends = facts.pop("coefficients")
        facts["coefficients"] = {name: (round(low, 6), round(high, 6)) for name, (low, high) in ends.items()}
    echo_facts(facts, as_json)


@click.command(name="convert", epilog="Example: litrig ptm convert coin.ptm coin-web")
@click.argument("source", metavar="A", type=PATH)
@click.argument("target", metavar="B", type=PATH)
@click.option(
    "--quality",
    type=click.IntRange(1, 100),
    metavar="Q",
    help="Of the JPEGs in a web folder; by default 100, which loses next to nothing.",
)
def convert(source: Path, target: Path, quality: int | None) -> None:
    """Write a material in another form.

    B's ending says which: .ptm (PTM of 6 terms), .rti (HSH of 4 or 9), .ptm.exr (anything, as float32 and without
    loss), or none for a web folder that OpenLIME shows. The basis stays what it is. An .rti and a folder of HSH hold
    coefficients a channel: colour and luminance that are apart are multiplied out.
    """
    from processing.ptm.files.either import read_any, write_any

    material = read_any(source)
    write_any(target, material, quality=quality)
    height, width = material.shape
    click.echo(f"{target}: {width} × {height} pixels, {material.basis}, {material.space} values")
