"""`litrig capture …`: sessions."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from acquisition.compare.cli import diff
from acquisition.plan_cli import plan
from acquisition.report.cli import report
from acquisition.session_info import SessionInfo, session_options
from rig.options import RECORD, RIG

if TYPE_CHECKING:
    from acquisition.plans import Plan, Step
    from acquisition.session import Operator
    from litrig.base.progress import Report
    from rig.config import RigConfig

FOLDER = click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
OUTPUT = click.option(
    "-o",
    "--output",
    "folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    required=True,
    help="Capture folder to make; absent or empty before.",
)
OTHER_RIG = click.option(
    "--rig",
    "rig_toml",
    metavar="RIG.toml",
    type=click.Path(path_type=Path),
    help="The rig as it is now; if left out, as the session has it.",
)
NEW_SEGMENT = click.option(
    "--new-segment", is_flag=True, help="Accept that the rig is configured otherwise, and write down how."
)
YES = click.option(
    "--yes", is_flag=True, help="Take what a person is asked to do (white card, lens cap) as done: ask nothing."
)
PAUSED_STATUS = 130


@dataclass(frozen=True)
class Foresight:
    """Somebody who wants to see steps before they are shot, such as a simulator that renders ahead; on the context.

    Attributes
    ----------
    announce : called with the steps, and with where to report progress
    """

    announce: "Callable[[Iterable[Step], Report], None]"


@click.group()
def capture() -> None:
    """Shoot sessions into capture folders that lose nothing, and check such folders.

    The first Ctrl-C pauses after the step under way and leaves the rig powered; the second stops it at once. Whatever
    ended a session, litrig capture resume goes on with it.
    """


capture.add_command(plan)
capture.add_command(report)
capture.add_command(diff)


@capture.command(epilog="Example: litrig capture run rig.toml plan.toml -o coin --object coin --operator 'A. Smith'")
@RIG
@click.argument("plan_toml", metavar="PLAN.toml", type=click.Path(path_type=Path))
@OUTPUT
@RECORD
@session_options
@YES
def run(rig_toml: Path, plan_toml: Path, folder: Path, info: SessionInfo, yes: bool) -> None:
    """Shoot a plan: slices, lights, or both, with brackets, averages and reference frames."""
    from acquisition.plans.plan_file import read_plan
    from rig.config import read_rig

    config = read_rig(rig_toml)
    _capture(config, read_plan(plan_toml, config), folder, info, yes)


@capture.command(epilog="Example: litrig capture amc rig.toml -o brushed --slices 128 --object brushed-steel")
@RIG
@OUTPUT
@RECORD
@click.option(
    "--slices", type=int, required=True, help="Frames over one turn, S_k; 2 to 4 times the table's size is ideal."
)
@click.option(
    "--closure", is_flag=True, help="Shoot the first slice again after the turn, to see what drifted or slipped."
)
@session_options
def amc(rig_toml: Path, folder: Path, slices: int, closure: bool, info: SessionInfo) -> None:
    """Shoot an Anisotropic MatCap session: a sphere of the material, turned about the camera's axis."""
    from acquisition.plans import amc_plan
    from rig.config import read_rig

    _capture(read_rig(rig_toml), amc_plan(slices, closure=closure), folder, info)


@capture.command(epilog="Example: litrig capture ptm rig.toml -o coin --lights 50 --object coin")
@RIG
@OUTPUT
@RECORD
@click.option(
    "--lights",
    type=int,
    required=True,
    help="Light directions, spread evenly; 40 to 80 are usual. Of a dome, as many of its lamps.",
)
@session_options
def ptm(rig_toml: Path, folder: Path, lights: int, info: SessionInfo) -> None:
    """Shoot a PTM session: a still object under a lamp that moves, or under the lamps of a dome."""
    from acquisition.plans import ptm_plan
    from rig.config import read_rig

    config = read_rig(rig_toml)
    _capture(config, ptm_plan(lights, config), folder, info)


@capture.command(epilog="Example: litrig capture resume coin --rig rig.toml")
@FOLDER
@OTHER_RIG
@NEW_SEGMENT
@RECORD
@YES
def resume(folder: Path, rig_toml: Path | None, new_segment: bool, yes: bool) -> None:
    """Go on with a session that was paused, stopped, put on hold or killed: shoot what is missing, and close it.

    Nothing is deleted: a picture that was shot but never acknowledged stays where it is, and is named.
    """
    from acquisition.session import resume as resume_session
    from acquisition.wanted import missing_steps, orphans, read_steps
    from litrig.base.capture_folder import layout
    from litrig.base.capture_folder.journal import read_journal
    from rig.config import read_rig

    config = None if rig_toml is None else read_rig(rig_toml)
    wanted, entries = read_steps(folder), read_journal(folder / layout.JOURNAL)
    missing = missing_steps(folder, wanted, entries)
    for orphan in orphans(folder, entries):
        click.echo(f"{folder}: {orphan}: shot, but never acknowledged; left as it is", err=True)
    click.echo(f"{folder}: {len(missing)} of {len(wanted)} steps to shoot", err=True)
    with _watched(folder.name, missing, yes) as operator:
        complete = resume_session(folder, config, new_segment=new_segment, operator=operator)
    _end(folder, complete)


@capture.command(epilog="Example: litrig capture retake coin --step 17 --step 18")
@FOLDER
@click.option("--step", "steps", type=int, multiple=True, required=True, help="Which to shoot again; may be repeated.")
@OTHER_RIG
@NEW_SEGMENT
@RECORD
@YES
def retake(folder: Path, steps: tuple[int, ...], rig_toml: Path | None, new_segment: bool, yes: bool) -> None:
    """Shoot steps again. The new frames count from then on; the old ones are kept."""
    from acquisition.session import retake as retake_steps
    from acquisition.wanted import read_steps
    from rig.config import read_rig

    config = None if rig_toml is None else read_rig(rig_toml)
    todo = [step for step in read_steps(folder) if step.step in steps]
    with _watched(folder.name, todo, yes) as operator:
        complete = retake_steps(folder, steps, config, new_segment=new_segment, operator=operator)
    _end(folder, complete)


@capture.command(epilog="Example: litrig capture verify coin")
@FOLDER
def verify(folder: Path) -> None:
    """Check every file of a capture folder against its journal and its manifests; nothing is changed."""
    from litrig.base.capture_folder.verify import verify_capture

    result = verify_capture(folder)
    for finding in result.findings:
        click.echo(f"litrig: {folder}: {finding}", err=True)
    for orphan in result.orphans:
        click.echo(f"{orphan}: shot, but never acknowledged (harmless)")
    if result.findings:
        raise SystemExit(1)
    click.echo(f"{folder}: {result.frames} frames, all as they were captured; the bag is valid")


def _capture(config: "RigConfig", plan: "Plan", folder: Path, info: SessionInfo, yes: bool = False) -> None:
    from acquisition.session import capture as run_session

    with _watched(info.object_id, plan, yes) as operator:
        complete = run_session(config, plan, folder, info, operator=operator)
    _end(folder, complete)


@contextmanager
def _watched(name: str, steps: "Iterable[Step]", yes: bool) -> "Iterator[Operator]":
    """Draw what happens, and ask a person on a terminal."""
    from acquisition.watching import watching
    from litrig.base.console import reporting

    foresight = click.get_current_context().find_object(Foresight)
    with reporting() as report:
        if foresight is not None:
            foresight.announce(steps, report)

        def ask(what: str) -> bool:
            if yes or not sys.stdin.isatty():
                return yes
            return report.ask(f"{what}, then press Enter")

        yield watching(f"capture {name}", report, ask)


def _end(folder: Path, complete: bool) -> None:
    from acquisition.consistency import suspects
    from litrig.base.capture_folder import layout
    from litrig.base.capture_folder.journal import read_journal
    from litrig.base.capture_folder.reader import good_frames

    frames = len(good_frames(read_journal(folder / layout.JOURNAL)))
    if not complete:
        click.echo(
            f"paused after {frames} frames; they are safe in {folder}, the rig stays powered, and litrig capture "
            f"resume {folder} goes on",
            err=True,
        )
        raise SystemExit(PAUSED_STATUS)
    closed = "closed as a valid bag" if layout.is_closed(folder) else "not closed: others are missing, resume it"
    click.echo(f"{folder}: {frames} frames, {closed}")
    if found := suspects(folder):
        others = f", and {len(found) - 1} more" if len(found) > 1 else ""
        click.echo(
            f"litrig: {folder}: warning: {found[0]}{others}; check lamps and cables, and look at litrig capture report",
            err=True,
        )
