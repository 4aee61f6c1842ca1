"""`litrig capture plan`: what a plan asks for, before anything moves."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from acquisition.plan_report import PlanReport, size_text
from litrig.base.errors import InputError
from litrig.base.files import is_folder

if TYPE_CHECKING:
    from acquisition.plans import Plan


@click.command(epilog="Example: litrig capture plan examples/plan-ptm.toml --rig rig.toml --plot coverage.png")
@click.argument("plan_toml", metavar="PLAN.toml", type=click.Path(path_type=Path))
@click.option(
    "--rig",
    "rig_toml",
    metavar="RIG.toml",
    type=click.Path(path_type=Path),
    help="The rig that it is for: every step is held against its limits, and time is forecast for it.",
)
@click.option(
    "--plot",
    "picture",
    metavar="IMAGE",
    type=click.Path(path_type=Path),
    help="Write a picture of lights and angles there, as PNG.",
)
@click.option(
    "-o",
    "--output",
    "folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Where the session would go: a plan that does not fit on that disk is refused.",
)
@click.option("--size", "table_size", type=click.IntRange(2, 4096), help="Side of the AMC table that is to be made.")
@click.option("--json", "as_json", is_flag=True, help="Print it for programs.")
def plan(
    plan_toml: Path,
    rig_toml: Path | None,
    picture: Path | None,
    folder: Path | None,
    table_size: int | None,
    as_json: bool,
) -> None:
    """Say what a plan asks for: frames, time, ways, coverage, disk. Nothing moves, and no port is opened.

    Without --rig, time and disk are those of a rig of RIG.toml's defaults, and limits are not checked.
    """
    from acquisition.coverage import coverage
    from acquisition.coverage_plot import plot_coverage
    from acquisition.forecast import forecast, usual_rig
    from acquisition.plan_check import check_against
    from acquisition.plans.plan_file import read_plan
    from rig.config import read_rig

    if picture is not None and picture.suffix.lower() != ".png":
        raise InputError(f"{picture}: the picture is a PNG; let its name end in .png")
    config = None if rig_toml is None else read_rig(rig_toml)
    planned = read_plan(plan_toml, config)
    try:
        remarks = [] if config is None else [*check_against(planned, config)]
        expected = forecast(planned, config or usual_rig())
    except InputError as error:
        raise InputError(f"{plan_toml}: {error}") from error
    free_bytes = None if folder is None else free_space(folder)
    if free_bytes is not None and free_bytes < expected.disk_bytes:
        raise InputError(
            f"{folder}: {size_text(free_bytes)} are free there, and {plan_toml} needs about "
            f"{size_text(expected.disk_bytes)}; free space, or choose another disk"
        )
    if advice := _advice(planned, table_size):
        remarks.append(advice)
    if config is None:
        remarks.append(
            "time and disk are those of a rig of RIG.toml's defaults; --rig tells yours, and checks its limits"
        )
    covered = coverage(planned)
    if picture is not None:
        plot_coverage(picture, planned, covered)
    report = PlanReport(planned, expected, covered, free_bytes, tuple(remarks))
    if as_json:
        click.echo(json.dumps(report.as_json(), indent=1, ensure_ascii=False))
    else:
        click.echo("\n".join(report.lines()))


def _advice(planned: "Plan", table_size: int | None) -> str:
    """Compare the slices of an AMC with the table's size."""
    turn = planned.poses.turn
    if turn is None or planned.poses.aims:
        return ""
    return (turn if table_size is None else replace(turn, table_size=table_size)).advice()


def free_space(folder: Path) -> int:
    """Return what is free where a folder is or would be."""
    place = next(place for place in (folder.absolute(), *folder.absolute().parents) if is_folder(place))
    return shutil.disk_usage(place).free
