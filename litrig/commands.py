"""One command that mounts what each package offers, and what it says when something is wrong."""

import errno
import os
import select
import signal
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click

from acquisition.cli import Foresight, capture
from firmware_sim.cli import sim
from firmware_sim.errors import SimError
from litrig.base.errors import LitrigError
from litrig.base.version import litrig_version
from processing.amc.cli import amc
from processing.matcap.cli import matcap
from processing.ptm.cli import ptm
from processing.shape.cli import shape
from rig.cli import rig
from viewer.cli import render, view

if TYPE_CHECKING:
    from acquisition.plans import Step
    from litrig.base.progress import Report

CHANNEL_VARIABLE = "LITRIG_SIM_CHANNEL"
"""Set by `litrig sim run` for the programs that it starts."""
INTERRUPTED_STATUS = 130
OUTPUT_IS_LOST = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EPIPE})


@click.group(epilog="Start with: litrig demo. Every command explains itself: litrig amc build --help")
@click.version_option(litrig_version(), prog_name="litrig")
@click.pass_context
def cli(context: click.Context) -> None:
    """Capture materials with a turntable and a light arm, and show them.

    A session goes into a capture folder (litrig capture), the folder becomes a material (litrig amc, litrig ptm), and
    the material becomes pictures (litrig render) or is looked at (litrig view). Everything runs without hardware too
    (litrig sim).
    """
    if channel := os.environ.get(CHANNEL_VARIABLE):
        context.obj = Foresight(lambda steps, report: _announce(Path(channel), steps, report))


def _announce(channel: Path, steps: "Iterable[Step]", report: "Report") -> None:
    from litrig.simulated import announce  # takes long to import, and few commands have a simulator behind them

    announce(channel, steps, report)


@cli.command(epilog="Example: litrig demo --out demo-out")
@click.option(
    "--out",
    "folder",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default=Path("litrig-demo"),
    show_default=True,
    help="Where the result goes; what an earlier demo left there is replaced.",
)
@click.option(
    "--scene",
    type=click.Choice(["analytic", "mitsuba"]),
    help="What the camera sees: formulas, or physically rendered frames. If left out, mitsuba where it runs fast.",
)
@click.option("--small", is_flag=True, help="Fewer frames and smaller tables: a quick look.")
def demo(folder: Path, scene: str | None, small: bool) -> None:
    """Run the whole path on a simulated rig; DIR/index.html shows it.

    A brushed sphere and a relief are captured through the real drivers, become an Anisotropic MatCap and a PTM, and are
    rendered. Takes about two minutes on two cores, and as much again to render frames with mitsuba for the first time.
    """
    from litrig.base.console import reporting
    from litrig.demo.run import DemoSize, run_demo
    from litrig.demo.scenes import SceneKind, best_scene

    kind = best_scene() if scene is None else SceneKind(scene)
    with reporting() as report:
        page = run_demo(folder, DemoSize.small() if small else DemoSize(), kind, report)
    click.echo(f"The demo is complete: open {page}")


for command in (sim, rig, capture, amc, ptm, matcap, shape, render, view):
    cli.add_command(command)


def run() -> int:
    """Run the command and return its exit status; every foreseen error is one line."""
    output = sys.stdout
    try:
        status = cli.main(standalone_mode=False)
        output.flush()
    except (LitrigError, SimError) as error:
        return _fail(str(error), getattr(error, "exit_status", 1))
    except click.ClickException as error:
        with suppress(OSError):
            error.show()
        return error.exit_code
    except (KeyboardInterrupt, click.Abort):
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is stopped; impatience must not change the exit status
        return _fail("interrupted", INTERRUPTED_STATUS)
    except OSError as error:
        if isinstance(error.__context__, KeyboardInterrupt):  # the terminal that click says so to was closed
            return _fail("interrupted", INTERRUPTED_STATUS)
        return _fail_on_system(error, output)
    except SystemExit:
        # A command's own status; or a pipe broke, for which click leaves with 1 and wraps the streams. The commands
        # print when their work is done, so a reader who has had enough (head -1) makes no failure of it.
        if sys.stdout is output or not _reader_left(output):
            raise
        _drop(output)
        return 0
    return status if isinstance(status, int) else 0


def _fail(message: str, status: int = 1) -> int:
    with suppress(OSError):  # with nowhere to say it, the status still tells
        click.echo(f"litrig: {message}", err=True)
    return status


def _fail_on_system(error: OSError, output: TextIO) -> int:
    """Say which file the system refused, or that what was printed is lost; anything else is a fault of ours."""
    if error.filename is not None:
        return _fail(f"{os.fsdecode(error.filename)}: {error.strerror}; check the name and its permissions")
    if error.errno not in OUTPUT_IS_LOST:
        raise error
    _drop(output)
    return _fail(f"standard output: cannot be written ({error.strerror}); free space, or send it elsewhere")


def _reader_left(output: TextIO) -> bool:
    poll = select.poll()
    poll.register(output.fileno(), 0)
    return any(event & select.POLLERR for _, event in poll.poll(0))


def _drop(output: TextIO) -> None:
    """Let what is still buffered go nowhere, so that it does not fail again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())
