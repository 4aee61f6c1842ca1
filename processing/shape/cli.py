"""`litrig shape …`: the shape of what a renderer drew, changed after rendering."""

import click


@click.group()
def shape() -> None:
    """Local shape editing of rendered pictures, from their shading buffers."""
