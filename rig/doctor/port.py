"""A serial port: is it there, may we open it, does anybody else use it, and does its adapter dawdle."""

import os
from pathlib import Path

import serial

from rig.doctor.bench import Bench
from rig.doctor.finding import Finding, Findings, Part
from rig.errors import PortError
from rig.serial_port import holders
from rig.udev import INSTALLED, RELOAD, SHIPPED

LONGEST_LATENCY_MS = 2
PSEUDO_TERMINALS = "/dev/pts/"


def try_port(bench: Bench, part: Part, path: str, baud: int) -> tuple[serial.Serial | None, list[Finding]]:
    """Open a port; it is None if that is refused, and the findings say why."""
    if holder := _lock_file_holder(bench, path):
        return None, [
            part.fault("port", f"{path}: taken by {holder}, says its lock file", "end that program and try again")
        ]
    try:
        port = bench.open_port(path, baud)
    except PortError as error:
        return None, [part.refused("port", error)]
    return port, [*_sharers(part, path), *_latency(bench, part, path)]


def _sharers(part: Part, path: str) -> Findings:
    """Look for programs that have it open without a lock. The far end of a pseudo-terminal may have it open."""
    others = "" if os.path.realpath(path).startswith(PSEUDO_TERMINALS) else holders(path)
    if others:
        yield part.warning("port", f"{path}: open in another program too ({others})", "end it, or answers get lost")
    else:
        yield part.ok("port", f"{path} opens, and nobody else has it open")


def _lock_file_holder(bench: Bench, path: str) -> str:
    """Name the process that a lock file of other serial programs names, if that process lives."""
    lock = bench.lock_root / f"LCK..{Path(os.path.realpath(path)).name}"
    try:
        pid = int(lock.read_text("ascii").split()[0])
        return f"process {pid}, {(bench.proc_root / str(pid) / 'comm').read_text('utf-8').strip()}"
    except (OSError, ValueError, IndexError):  # no lock, or a stale one
        return ""


def _latency(bench: Bench, part: Part, path: str) -> Findings:
    """Read how long the adapter keeps short answers back; only some adapters do that at all."""
    name = Path(os.path.realpath(path)).name
    timer = bench.sys_root / "bus/usb-serial/devices" / name / "latency_timer"
    try:
        latency_ms = int(timer.read_text("ascii"))
    except (OSError, ValueError):
        return
    if latency_ms > LONGEST_LATENCY_MS:
        yield part.warning(
            "latency",
            f"{path}: the adapter keeps every answer back for {latency_ms} ms",
            f"echo 1 | sudo tee {timer}; for good: sudo cp {SHIPPED} {INSTALLED} && {RELOAD}",
        )
    else:
        yield part.ok("latency", f"the adapter keeps answers back for {latency_ms} ms")
