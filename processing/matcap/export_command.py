"""`litrig matcap export`: a decomposed MatCap for other programs."""

from pathlib import Path

import click

from processing.command_parts import PATH


@click.command(epilog="Example: litrig matcap export gold.matcap.exr -o gold-blender.exr --size 512")
@click.argument("file", metavar="X.matcap.exr", type=PATH)
@click.option("-o", "--output", metavar="Y.exr", type=PATH, required=True, help="What to write.")
@click.option(
    "--size", metavar="PX", type=click.IntRange(1, 16384), help="Side of the picture; that of the source if left out."
)
def export(file: Path, output: Path, size: int | None) -> None:
    """Write a MatCap for Blender: the low frequencies as its diffuse pass, the high ones as specular.

    Put the file where Blender installs MatCaps from (Preferences, Lights), with all edits as they show now.
    """
    from litrig.base.errors import InputError
    from processing.matcap.blender_exr import LARGEST, write_blender_matcap
    from processing.matcap.matcap_exr import ENDING, read_matcap
    from processing.matcap.render import half_pictures

    if output.name.lower().endswith(ENDING):
        raise InputError(f"{output}: is a name of litrig's own; end it in .exr alone, or use matcap edit")
    low, high = half_pictures(read_matcap(file), size)
    write_blender_matcap(output, low, high)
    brightest = max(low.max(), high.max())
    if brightest > LARGEST:
        click.echo(
            f"{output}: light of up to {brightest:.3g} is cut off at {LARGEST:g}, all that it can hold", err=True
        )
    click.echo(f"{output}: {low.shape[1]} × {low.shape[0]} pixels, passes diffuse and specular")
