"""The light arm on its simulated controller, beside what the wire and physics ask for."""

import itertools
import select

import serial

from benchmarks.measure import Comparison, compare
from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
from rig.arm.geometry import Joints
from rig.arm.travel import Travel
from rig.clock import MonotonicClock
from rig.config import ArmConfig, read_rig
from rig.grbl.arm import GrblArm
from rig.grbl.controller import GrblController
from rig.serial_port import open_serial

REPORTS = 500
STEP_DEG = 60.0


def comparisons() -> list[Comparison]:
    """Compare status reports with bare questions on the same port, and a move with the time that it must take."""
    clock = MonotonicClock()
    with simulated_rig(SimConfig.model_validate({"scene": {"kind": "relief"}})) as sim:
        config = read_rig(sim.rig_toml).arm
        if not isinstance(config, ArmConfig):
            raise TypeError("the simulated rig has a GRBL arm")
        port = open_serial(config.port, config.baud)
        controller = GrblController(config.port, config.baud, clock, port)
        arm = GrblArm(controller, config, clock)
        arm.home()
        azimuths = itertools.cycle((100.0 + STEP_DEG, 100.0))
        arm.move_to(100.0, 45.0)
        needed_s = Travel.of(config).time_s(Joints(0.0, 0.0), Joints(STEP_DEG, 0.0))
        rows = [
            compare(
                f"{REPORTS} status reports, asked and understood",
                ("driver over the wire", lambda: [controller.status() for _ in range(REPORTS)]),
                ("bytes alone", lambda: [_ask(port) for _ in range(REPORTS)]),
            ),
            compare(
                f"Arm's move of {STEP_DEG:g}°, goal sent to settled",
                ("light arm over the wire", lambda: arm.move_to(next(azimuths), 45.0)),
                ("the profile's own time", lambda: clock.sleep(needed_s)),
                goal="≤ 1.1",
            ),
        ]
        arm.close()
        return rows


def _ask(port: serial.Serial) -> bytes:
    port.write(b"?")
    heard = b""
    while not heard.endswith(b"\n"):
        select.select([port.fileno()], [], [], 1.0)
        heard += port.read(4096)
    return heard
