"""`litrig sim`: a capture rig for those who have none at hand."""

import os
from pathlib import Path

import click


@click.group()
def sim() -> None:
    """Simulate a capture rig: turntable, light arm, camera."""


@sim.command(
    context_settings={"allow_interspersed_args": False},
    epilog="Example: litrig sim run examples/sim-amc.toml -- sh -c 'litrig rig move $LITRIG_RIG --angle 30'",
)
@click.argument("sim_toml", metavar="SIM.toml", type=click.Path(path_type=Path))
@click.argument("command", metavar="-- COMMAND…", nargs=-1, required=True, type=click.UNPROCESSED)
@click.pass_context
def run(context: click.Context, sim_toml: Path, command: tuple[str, ...]) -> None:
    """Start the simulated devices, run COMMAND against them, stop them.

    COMMAND finds a servo turntable and a light arm on serial ports, and a camera; the file that $LITRIG_RIG names
    describes them. Nothing in litrig knows that they are simulated. If COMMAND is killed, the devices keep their state
    until it is over, so that a shell as COMMAND can start something again. The exit status is that of COMMAND.
    """
    from firmware_sim.config import read_sim
    from firmware_sim.foreground import run_in_front
    from firmware_sim.launch import simulated_rig

    command = command[1:] if command[0] == "--" else command  # the parser stops at SIM.toml and leaves it in
    if not command:
        raise click.UsageError("name a COMMAND to run, after --", context)
    with simulated_rig(read_sim(sim_toml)) as rig:
        status = run_in_front(command, os.environ | rig.environment)
    context.exit(status)
