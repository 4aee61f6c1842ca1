"""`litrig capture report`."""

import json
from pathlib import Path

import click


@click.command(epilog="Example: litrig capture report coin")
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--output",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Folder of the report; by default FOLDER.report. An earlier report there is replaced.",
)
@click.option("--json", "as_json", is_flag=True, help="Print what the page says as JSON.")
def report(folder: Path, output: Path | None, as_json: bool) -> None:
    """Write a page that looks back at a session, in any state, beside its folder.

    A contact sheet by pose, with what a person should look at marked; light, exposure, focus, pose errors, and where
    the time went; what happened, in order.
    """
    from acquisition.report.report import write_report

    written = write_report(folder, output)
    click.echo(json.dumps(written.summary, ensure_ascii=False) if as_json else f"{written.page}")
