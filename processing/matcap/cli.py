"""`litrig matcap …`: a MatCap taken apart, changed, and put together again."""

import click

from processing.matcap.decompose_command import decompose
from processing.matcap.edit_command import edit
from processing.matcap.estimate_command import estimate
from processing.matcap.export_command import export
from processing.matcap.info_command import info
from processing.matcap.split_command import split


@click.group()
def matcap() -> None:
    """MatCaps: separate, estimate, decompose, and change light and material."""


matcap.add_command(decompose)
matcap.add_command(edit)
matcap.add_command(estimate)
matcap.add_command(export)
matcap.add_command(info)
matcap.add_command(split)
