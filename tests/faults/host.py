"""Faults of the computer that the rig hangs on: ports that are forbidden or taken, a second litrig, disks."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from rig.config import TurntableConfig, read_rig
from rig.doctor.disk import check_disk
from rig.doctor.finding import State
from rig.doctor.passive import examine
from rig.errors import PortError
from rig.rig import open_rig
from rig.udev import rule_for
from tests.faults.outcome import Outcome, Scale
from tests.system.command import litrig, start

MOST_S = 1.0
ARRIVAL_DEG = 0.3
NOBODY = 65_534
NOT_ROOT = "not tried: needs root"
PARTS = frozenset({"turntable"})

# What is lazily imported is imported before the rights are given up: nobody may not read it any more.
_AS_NOBODY = f"""
import os, sys
import litrig.commands, rig.rig, rig.dynamixel.driver, rig.wire_record, rig.doctor.passive, rig.doctor.moving
import rig.doctor.bundle, rig.doctor.report, rig.init.discovery, rig.interrupts
os.setgroups([]); os.setgid({NOBODY}); os.setuid({NOBODY})
sys.argv[0] = "litrig"
sys.exit(litrig.commands.run())
"""

_HOLD = """
import sys, serial
port = serial.Serial(sys.argv[1], exclusive=True)
print("held", flush=True)
sys.stdin.read()
"""


def fault_19_permission_denied(campaign: Scale) -> Outcome:
    """A user who may not open the port gets the exact udev rule, from a command and from the doctor."""
    if os.getuid() != 0:
        return Outcome(0, 0, NOT_ROOT, passed=True)
    wrong = 0
    with _open_folder() as folder, _port_of_root() as port:
        (folder / "rig.toml").write_text(f'[turntable]\nport = "{port}"\n')
        (folder / "rig.toml").chmod(0o644)
        rule = rule_for(port)
        for trial in range(campaign.trials):
            verb = ("home", "doctor")[trial % 2]
            result = _as_nobody("rig", verb, str(folder / "rig.toml"))
            said = result.stdout + result.stderr
            told = f"{port}: permission denied" in said and rule in said and "Traceback" not in said
            wrong += not (told and result.returncode == 1)
    return Outcome(campaign.trials, wrong, f"refused with the rule {rule}", passed=wrong == 0)


def fault_20_port_held(campaign: Scale) -> Outcome:
    """Another program holds the port: refused within a second, the holder named, its port left alone."""
    wrong, slowest_s = 0, 0.0
    with simulated_rig(SimConfig()) as sim:
        config = read_rig(sim.rig_toml)
        assert isinstance(config.turntable, TurntableConfig)
        command = [sys.executable, "-c", _HOLD, config.turntable.port]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
            assert holder.stdout is not None
            assert holder.stdout.readline() == b"held\n"
            before = _heard(sim)
            for _ in range(campaign.trials):
                took_s, message = _refusal(lambda: open_rig(config, use=PARTS))
                slowest_s = max(slowest_s, took_s)
                wrong += not (took_s < MOST_S and "held by another program" in message)
                wrong += f"process {holder.pid}," not in message
            found = examine(config.model_copy(update={"camera": None}), patience_s=30)
            wrong += not any(f"process {holder.pid}," in finding.what for finding in found)
            wrong += _heard(sim) != before
            assert holder.stdin is not None
            holder.stdin.close()
    detail = f"refused within {slowest_s:.3f} s, the process named, no byte on its wire; the doctor names it too"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


def fault_21_second_litrig(campaign: Scale) -> Outcome:
    """A second litrig on the rig, by another part and another file, is refused; the first arrives."""
    wrong, slowest_s = 0, 0.0
    with simulated_rig(SimConfig()) as sim, tempfile.TemporaryDirectory() as folder:
        other = Path(folder) / "copy.toml"
        shutil.copy(sim.rig_toml, other)
        config = read_rig(other)
        for trial in range(campaign.trials):
            goal_deg = 120.0 if trial % 2 == 0 else -30.0
            first = start("rig", "move", sim.rig_toml, "--angle", str(goal_deg), environment=sim.environment)
            _wait_until(lambda: bool(sim.side_channel.status()["turntable_moving"]))
            for parts in (PARTS, frozenset({"arm"}), frozenset({"camera"})):
                took_s, message = _refusal(lambda parts=parts: open_rig(config, use=parts))  # type: ignore[misc]
                slowest_s = max(slowest_s, took_s)
                wrong += not (took_s < MOST_S and f"in use by litrig, process {first.pid};" in message)
            output, error = first.communicate(timeout=60)
            wrong += first.returncode != 0 or bool(error)
            wrong += abs(float(output.removeprefix("turntable at ").rstrip("°\n")) - goal_deg) > ARRIVAL_DEG
    detail = f"refused within {slowest_s:.3f} s by the rig's lock, which names the first; the first arrived"
    return Outcome(campaign.trials, wrong, detail, passed=wrong == 0)


def fault_35_read_only_folder(campaign: Scale) -> Outcome:
    """A folder that cannot be written: the doctor says so, and a session is refused before anything moves."""
    if os.getuid() != 0:
        return Outcome(0, 0, NOT_ROOT, passed=True)
    wrong = 0
    with small_disk("ro") as disk, simulated_rig(SimConfig()) as sim:
        if disk is None:
            return Outcome(0, 0, "not tried: needs the right to mount", passed=True)
        before_deg = sim.side_channel.status()["turntable_deg"]
        for _ in range(campaign.trials):
            findings = list(check_disk(disk / "session"))
            wrong += [finding.state for finding in findings] != [State.FAULT]
            wrong += "cannot be written" not in findings[0].what
            session = ("capture", "amc", sim.rig_toml, "-o", disk / "session", "--slices", "8")
            result = litrig(*session, environment=sim.environment)
            wrong += result.returncode != 1 or str(disk) not in result.stderr or "Traceback" in result.stderr
            wrong += sim.side_channel.status()["turntable_deg"] != before_deg
    return Outcome(campaign.trials, wrong, "named by the doctor; a session refused, nothing moved", passed=wrong == 0)


def fault_35_disk_too_small(campaign: Scale) -> Outcome:
    """A disk that a session would fill: the doctor says how little room there is."""
    if os.getuid() != 0:
        return Outcome(0, 0, NOT_ROOT, passed=True)
    wrong = 0
    with small_disk("rw") as disk:
        if disk is None:
            return Outcome(0, 0, "not tried: needs the right to mount", passed=True)
        for _ in range(campaign.trials):
            room = next(finding for finding in check_disk(disk) if finding.name == "room")
            wrong += room.state is not State.FAULT or list(disk.iterdir()) != []
        (disk / "ballast").write_bytes(bytes(4_100_000))
        room = next(finding for finding in check_disk(disk) if finding.name == "room")
        wrong += "full" not in room.what
    return Outcome(campaign.trials, wrong, "a disk of 4 MB is named, empty and full", passed=wrong == 0)


def _refusal(attempt: Callable[[], object]) -> tuple[float, str]:
    """Say how long it took until an attempt was refused, and with what words."""
    start_s = time.monotonic()
    try:
        attempt()
    except PortError as error:
        return time.monotonic() - start_s, str(error)
    return time.monotonic() - start_s, "not refused"


def _heard(sim: RunningSim) -> list[object]:
    return list(sim.side_channel.status()["wires"]["turntable"]["recent"])


def _wait_until(true: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + 60
    while not true():
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.01)  # noqa: TID251  # a process outside is waited for


def _as_nobody(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-c", _AS_NOBODY, *arguments], capture_output=True, text=True, timeout=60, check=False
    )


@contextmanager
def _open_folder() -> Iterator[Path]:
    """Make a folder that everybody can read, as pytest's are not."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


@contextmanager
def _port_of_root() -> Iterator[str]:
    master, slave = os.openpty()
    tty.setraw(slave)
    try:
        Path(os.ttyname(slave)).chmod(0o600)
        yield os.ttyname(slave)
    finally:
        os.close(master)
        os.close(slave)


@contextmanager
def small_disk(mode: str) -> Iterator[Path | None]:
    """Mount a disk of 4 MB; None where that is not allowed."""
    with tempfile.TemporaryDirectory() as folder:
        mount = ["mount", "-t", "tmpfs", "-o", f"{mode},size=4m", "tmpfs", folder]
        if shutil.which("mount") is None or subprocess.run(mount, capture_output=True, check=False).returncode:
            yield None
            return
        try:
            yield Path(folder)
        finally:
            subprocess.run(["umount", folder], capture_output=True, check=True)
