"""What the checks look at: the rig, and the machine that it hangs on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import serial

from rig.clock import Clock, MonotonicClock
from rig.config import RigConfig
from rig.serial_port import open_serial

OpenPort = Callable[[str, int], serial.Serial]


@dataclass(frozen=True)
class Bench:
    """A rig and its machine.

    Attributes
    ----------
    config : the RIG.toml
    deadline_s : on the clock; what has not answered by then hangs
    folder : where sessions are to go
    environment : added to the environment of the camera's process
    open_port : opens a serial port at a baud rate
    sys_root, proc_root, lock_root : where the kernel and other programs say what they know
    """

    config: RigConfig
    deadline_s: float
    folder: Path = Path()
    clock: Clock = field(default_factory=MonotonicClock)
    environment: Mapping[str, str] = field(default_factory=dict)
    open_port: OpenPort = open_serial
    sys_root: Path = Path("/sys")
    proc_root: Path = Path("/proc")
    lock_root: Path = Path("/run/lock")

    def left_s(self) -> float:
        """How much time there is until the deadline."""
        return max(0.0, self.deadline_s - self.clock.now_s())
