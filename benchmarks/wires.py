"""Moves and exchanges on the simulated rig, beside the time that physics asks for, and beside the SDK on its own."""

import math
from dataclasses import replace

from dynamixel_sdk import PacketHandler, PortHandler

from benchmarks.measure import Comparison, compare
from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from rig.clock import MonotonicClock
from rig.config import TurntableConfig, read_rig
from rig.dynamixel import registers
from rig.dynamixel.link import DynamixelLink
from rig.dynamixel.registers import profile_time_s
from rig.rig import open_rig

STEP_DEG = 30.0
EXCHANGES = 500


def comparisons() -> list[Comparison]:
    """Compare a move with its profile, and exchanges with those of the bare SDK."""
    return [*_exchanges(), *_moves()]


def _exchanges() -> list[Comparison]:
    """Read the present position many times; the SDK on its own keeps a core busy while it waits."""
    with simulated_rig(SimConfig()) as sim:
        config = read_rig(sim.rig_toml).turntable
        assert isinstance(config, TurntableConfig), "the simulated rig has a servo"

        def ours() -> None:
            link = DynamixelLink(config.port, config.baud, config.id, MonotonicClock())
            positions = {link.read(registers.PRESENT_POSITION) for _ in range(EXCHANGES)}
            link.close()
            if len(positions) != 1:
                raise AssertionError(f"a table at rest was read at {positions}")

        def bare() -> None:
            port, packets = PortHandler(config.port), PacketHandler(2.0)
            port.setBaudRate(config.baud)
            for _ in range(EXCHANGES):
                packets.read4ByteTxRx(port, config.id, registers.PRESENT_POSITION.address)
            port.closePort()

        row = compare(f"{EXCHANGES} exchanges with the servo", ("over our bus", ours), ("over the bare SDK", bare))
    rate = f"over our bus: {EXCHANGES / row.ours_s:.0f} a second"
    return [replace(row, ours=rate, goal="≤ 1.2")]


def _moves() -> list[Comparison]:
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
