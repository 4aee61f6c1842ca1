"""The front door: one command that mounts what each package offers."""

import os
import sys
from pathlib import Path

import click

from acquisition.cli import capture
from firmware_sim.cli import sim
from firmware_sim.errors import SimError
from litrig.base.errors import LitrigError
from litrig.base.version import litrig_version
from processing.cli import amc, ptm
from rig.cli import rig
from viewer.cli import render

INTERRUPTED_STATUS = 130


@click.group(epilog="Start with: litrig demo. Every command explains itself: litrig amc build --help")
@click.version_option(litrig_version(), prog_name="litrig")
def cli() -> None:
    """Capture materials with a turntable and a light arm, and show them.

    A session goes into a capture folder (litrig capture), the folder becomes a material (litrig amc, litrig ptm), and
    the material becomes pictures (litrig render). Everything runs without hardware too (litrig sim).
    """


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
@click.option("--small", is_flag=True, help="Fewer frames and smaller tables: a quick look.")
def demo(folder: Path, small: bool) -> None:
    """Run the whole path on a simulated rig; DIR/index.html shows it.

    A brushed sphere and a relief are captured through the real drivers, become an Anisotropic MatCap and a PTM, and are
    rendered. Takes about two minutes on two cores.
    """
    from litrig.base.console import reporting
    from litrig.demo.run import DemoSize, run_demo
    from litrig.demo.scenes import SceneKind

    with reporting() as report:
        page = run_demo(folder, DemoSize.small() if small else DemoSize(), SceneKind.ANALYTIC, report)
    click.echo(f"The demo is complete: open {page}")


for command in (sim, rig, capture, amc, ptm, render):
    cli.add_command(command)


def main() -> None:
    """Run the command; every foreseen error is one line and an exit status."""
    try:
        status = cli.main(standalone_mode=False)
    except (LitrigError, SimError) as error:
        click.echo(f"litrig: {error}", err=True)
        status = getattr(error, "exit_status", 1)
    except click.ClickException as error:
        error.show()
        status = error.exit_code
    except BrokenPipeError:
        # Whoever read our output has had enough. What is still buffered must not fail again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 1
    except (KeyboardInterrupt, click.Abort):
        click.echo("litrig: interrupted", err=True)
        status = INTERRUPTED_STATUS
    sys.exit(status if isinstance(status, int) else 0)
