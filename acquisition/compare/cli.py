"""`litrig capture diff`."""

import json
from pathlib import Path

import click


@click.command(epilog="Example: litrig capture diff coin-monday coin-friday")
@click.argument("a", metavar="A", type=click.Path(path_type=Path))
@click.argument("b", metavar="B", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print it as JSON.")
def diff(a: Path, b: Path, as_json: bool) -> None:
    """Say what differs between two sessions: settings, plan, exposure, instruments, versions.

    Device paths do not count, for a port may come back under another name. Frames are compared where both sessions have
    one of the same pose, within the tolerances of A's rig. The exit status is 0 whether or not anything differs.
    """
    from acquisition.compare import lines
    from acquisition.compare.comparison import compare

    found = compare(a, b)
    if as_json:
        click.echo(json.dumps(lines.as_json(found), ensure_ascii=False))
    else:
        click.echo("\n".join(lines.lines_of(found)))
