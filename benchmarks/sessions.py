"""How long a session takes beside what moving, settling and exposing take, on simulated rigs, every write synced."""

import statistics
from collections.abc import Sequence
from pathlib import Path

from acquisition.session import capture
from acquisition.session_info import SessionInfo
from benchmarks.measure import Comparison
from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import Entry, read_journal
from rig.config import read_rig
from tests.faults.step_plans import lamps_of_dome, lights_of_arm, turn

ROUNDS = 3
LAMPS = 24
RIGS: tuple[tuple[str, dict[str, object]], ...] = (
    ("AMC of 16 slices", {}),
    ("PTM of 8 lights on an arm", {"scene": {"kind": "relief"}}),
    (f"PTM of {LAMPS} lamps on a dome", {"scene": {"kind": "relief"}, "dome": {"lamps": LAMPS}}),
)


def comparisons(folder: Path) -> list[Comparison]:
    """Compare whole sessions with their parts that cannot be shorter."""
    rows = []
    for what, config in RIGS:
        with simulated_rig(SimConfig.model_validate(config)) as sim:
            times = [_session(sim, what, folder / f"{what}-{number}") for number in range(ROUNDS)]
        ratios = [took_s / needed_s for took_s, needed_s in times]
        rows.append(
            Comparison(
                f"Session on the simulated rig: {what}",
                "first move to last frame on the disk",
                "moves + settles + exposures",
                statistics.median(ratios),
                (min(ratios), max(ratios)),
                statistics.median(took_s for took_s, _ in times),
                "≤ 1.10",
            )
        )
    return rows


def _session(sim: RunningSim, what: str, folder: Path) -> tuple[float, float]:
    """Shoot one, and return how long it took, and how long its moves, settles and exposures."""
    config = read_rig(sim.rig_toml)
    has_dome = config.lights is not None and config.lights.directions_deg
    plan = turn(16) if what.startswith("AMC") else lamps_of_dome(config) if has_dome else lights_of_arm(8)
    assert capture(config, plan, folder, SessionInfo("bench"), environment=sim.environment)
    entries = read_journal(folder / layout.JOURNAL)
    frames = [entry for entry in entries if entry["ev"] == "frame"]
    assert len(frames) == len(plan)
    return _took_s(entries, frames), sum(map(_needed_s, frames))


def _took_s(entries: Sequence[Entry], frames: Sequence[Entry]) -> float:
    """Count from the first move to the last frame's line: homing comes before, parking and closing behind."""
    first = frames[0]
    began_s = first["exposed"]["to_s"] - _needed_s(first)
    return float(frames[-1]["mono_ns"] / 1e9 - began_s)


def _needed_s(frame: Entry) -> float:
    return float(sum(frame["times_s"][part] for part in ("move", "settle", "expose")))
