"""`litrig matcap …`: a MatCap taken apart, changed, and put together again."""

import click

from processing.matcap.estimate_command import estimate
from processing.matcap.split_command import split


@click.group()
def matcap() -> None:
    """MatCaps: separate, estimate, decompose, and change light and material."""


matcap.add_command(estimate)
matcap.add_command(split)
