"""`litrig rig doctor`."""

import json
import tempfile
from contextlib import ExitStack
from pathlib import Path

import click

from rig.options import RECORD, RIG


@click.command(epilog="Example: litrig rig doctor rig.toml --move --bundle report.zip")
@RIG
@RECORD
@click.option("--move", is_flag=True, help="Move everything too: homing, travel, arrival, and what the lamps do.")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as one JSON object.")
@click.option(
    "--bundle",
    metavar="ZIP",
    type=click.Path(path_type=Path),
    help="Pack what a bug report needs: versions, configuration, findings, wires. What is private is hidden.",
)
@click.option(
    "--wires",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="A record of a session (--record) to pack into the bundle as well.",
)
@click.option(
    "--out",
    "folder",
    metavar="DIR",
    type=click.Path(path_type=Path),
    default=Path(),
    help="Where sessions are to go; by default the current folder.",
)
def doctor(rig_toml: Path, move: bool, as_json: bool, bundle: Path | None, wires: Path | None, folder: Path) -> None:
    """Say what is connected, what is wrong, and what to do about it.

    Nothing moves without --move, and it takes 5 seconds at most: ports, servo, controller, camera, lights, disk and
    clock are looked at side by side. The exit status is 0 for a healthy rig, and 1 if there are faults.
    """
    from litrig.base.errors import InputError
    from rig.clock import MonotonicClock
    from rig.config import read_rig
    from rig.doctor.bundle import write_bundle
    from rig.doctor.finding import Finding
    from rig.doctor.moving import examine_moving
    from rig.doctor.passive import examine
    from rig.doctor.report import as_json as report_of
    from rig.doctor.report import is_healthy, lines_of, summary
    from rig.interrupts import Interrupts
    from rig.wire_record import read_record, recording

    def tell(finding: Finding) -> None:
        for line in () if as_json else lines_of(finding):
            click.echo(line)

    if wires is not None and bundle is None:
        raise InputError("--wires: goes into a bundle; name one with --bundle")
    config = read_rig(rig_toml)
    session = [] if wires is None else read_record(wires)
    clock = MonotonicClock()
    start_s = clock.now_s()
    with ExitStack() as stack:
        record = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "wires.jsonl"
        if bundle is not None:
            stack.enter_context(recording(record))
        findings = examine(config, folder)
        for finding in findings:
            tell(finding)
        if move and is_healthy(findings):
            with Interrupts(can_pause=False):
                for finding in examine_moving(config):
                    tell(finding)
                    findings.append(finding)
        elif move:
            click.echo("Nothing was moved; mend the faults first.", err=True)
        report = report_of(config.rig.name, findings, clock.now_s() - start_s)
        if bundle is not None:
            write_bundle(bundle, config, report, read_record(record), session)
    if as_json:
        click.echo(json.dumps(report, indent=1, ensure_ascii=False))
    else:
        click.echo(summary(findings))
        if bundle is not None:
            click.echo(f"wrote {bundle}; look through it before you give it away")
    if not is_healthy(findings):
        raise SystemExit(1)
