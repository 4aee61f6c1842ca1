"""`litrig capture …`: sessions."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rig.options import RECORD, RIG

if TYPE_CHECKING:
    from acquisition.plans import Plan
    from litrig.base.progress import Report
    from rig.config import RigConfig

OUTPUT = click.option(
    "-o",
    "--output",
    "folder",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    required=True,
    help="Capture folder to make; absent or empty before.",
)
OBJECT = click.option("--object", "object_id", default="object", show_default=True, help="What stands on the table.")

PAUSED_STATUS = 130


@dataclass(frozen=True)
class Foresight:
    """Somebody who wants to see a plan before it is shot, such as a simulator that renders ahead; found on the context.

    Attributes
    ----------
    announce : called with the plan, and with where to report progress
    """

    announce: "Callable[[Plan, Report], None]"


@click.group()
def capture() -> None:
    """Shoot sessions into capture folders that lose nothing, and check such folders.

    The first Ctrl-C pauses after the step under way and leaves the rig powered; the second stops it at once.
    """


@capture.command(epilog="Example: litrig capture amc rig.toml -o brushed --slices 128 --object brushed-steel")
@RIG
@OUTPUT
@RECORD
@click.option(
    "--slices", type=int, required=True, help="Frames over one turn, S_k; 2 to 4 times the table's size is ideal."
)
@OBJECT
@click.option(
    "--tangent-zero",
    "tangent_zero_deg",
    type=click.FloatRange(-360, 360),
    default=0.0,
    show_default=True,
    help="Direction of brushing or thread at turntable zero, in degrees from the picture's right, counter-clockwise.",
)
@click.option(
    "--closure", is_flag=True, help="Shoot the first slice again after the turn, to see what drifted or slipped."
)
def amc(rig_toml: Path, folder: Path, slices: int, object_id: str, tangent_zero_deg: float, closure: bool) -> None:
    """Shoot an Anisotropic MatCap session: a sphere of the material, turned about the camera's axis."""
    from acquisition.plans import amc_plan
    from rig.config import read_rig

    _capture(read_rig(rig_toml), amc_plan(slices, closure=closure), folder, object_id, tangent_zero_deg)


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
@OBJECT
def ptm(rig_toml: Path, folder: Path, lights: int, object_id: str) -> None:
    """Shoot a PTM session: a still object under a lamp that moves, or under the lamps of a dome."""
    from acquisition.plans import ptm_plan
    from rig.config import read_rig

    config = read_rig(rig_toml)
    _capture(config, ptm_plan(lights, config), folder, object_id, 0.0)


@capture.command(epilog="Example: litrig capture verify coin")
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
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


def _capture(config: "RigConfig", plan: "Plan", folder: Path, object_id: str, tangent_zero_deg: float) -> None:
    from acquisition.session import SessionInfo
    from acquisition.session import capture as run_session
    from litrig.base.console import reporting

    info = SessionInfo(object_id, tangent_zero_deg)
    foresight = click.get_current_context().find_object(Foresight)
    with reporting() as report:
        if foresight is not None:
            foresight.announce(plan, report)
        complete = run_session(config, plan, folder, info, report=report)
    if not complete:
        click.echo(f"paused; the frames so far are safe in {folder}, the rig stays powered", err=True)
        raise SystemExit(PAUSED_STATUS)
    click.echo(f"{folder}: {len(plan)} frames, closed as a valid bag")
