"""Moves and exchanges on the simulated rig, beside the time that physics asks for."""

import math

from benchmarks.measure import Comparison, compare
from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from rig.clock import MonotonicClock
from rig.config import TurntableConfig, read_rig
from rig.dynamixel.registers import profile_time_s
from rig.rig import open_rig

STEP_DEG = 30.0


def comparisons() -> list[Comparison]:
    """Compare a move with its profile, and a pose with nothing else to do."""
    clock = MonotonicClock()
    with simulated_rig(SimConfig()) as sim, open_rig(read_rig(sim.rig_toml), use=frozenset({"turntable"})) as rig:
        rig.home()
        config = rig.config.turntable
        if not isinstance(config, TurntableConfig):
            raise TypeError("the simulated rig has a Dynamixel turntable")
        goals = iter(math.remainder(STEP_DEG * i, 720) for i in range(1, 1000))
        rig.turn_to(0.0)
        return [
            compare(
                f"Move of {STEP_DEG:g}°, goal sent to settled",
                ("turntable over the wire", lambda: rig.turn_to(next(goals))),
                ("the profile's own time", lambda: clock.sleep(_profile_s(config))),
                goal="≤ 1.1",
            ),
        ]


def _profile_s(config: TurntableConfig) -> float:
    return profile_time_s(STEP_DEG, config.speed_deg_s, config.acceleration_deg_s2)
