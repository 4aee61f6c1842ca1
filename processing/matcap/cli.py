"""`litrig matcap …`: a MatCap taken apart, changed, and put together again."""

import click


@click.group()
def matcap() -> None:
    """MatCaps: separate, estimate, decompose, and change light and material."""
