"""`litrig shape …`: the shape of what a renderer drew, changed after rendering."""

import click

from processing.shape.info_command import info
from processing.shape.recompose_command import recompose
from processing.shape.reconstruct_command import reconstruct


@click.group()
def shape() -> None:
    """Local shape editing of rendered pictures, from their shading buffers."""


shape.add_command(info)
shape.add_command(reconstruct)
shape.add_command(recompose)
