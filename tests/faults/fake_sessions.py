"""Whole sessions on devices in memory: begun, resumed and retaken by the functions that the command calls."""

import itertools
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Self
from unittest.mock import patch

import numpy as np
import simplejpeg

from acquisition.plans import Step
from acquisition.session import capture, resume, retake
from acquisition.session_info import SessionInfo
from litrig.base.capture_folder.journal import Entry
from litrig.base.capture_folder.lock import FolderLock
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.radiometry import U8
from litrig.base.store import DISK, Store
from rig.config import ArmConfig, RigConfig, SpindleLampConfig, TurntableConfig
from rig.fakes import FakeArm, FakeCamera, FakeClock, FakeLights, FakeTurntable
from rig.rig import Rig
from tests.faults.step_plans import StepsPlan

MEMORY = Path("/dev/shm")
HEIGHT, WIDTH = 48, 64
_NUMBERS = itertools.count()
_ENTRY_POINTS = cache(entry_points)


@contextmanager
def quick_folder() -> Iterator[Path]:
    """Make a folder in memory, where the machine has room there: a sync costs nothing."""
    with tempfile.TemporaryDirectory(dir=MEMORY if MEMORY.is_dir() else None) as name:
        yield Path(name)


def painted(angle_deg: float, shade: float = 1.0) -> U8:
    """Paint a smooth pattern that turns with the table, and a pixel that no other picture has."""
    y, x = np.mgrid[-1 : 1 : HEIGHT * 1j, -1 : 1 : WIDTH * 1j]
    along = x * np.cos(np.radians(angle_deg)) + y * np.sin(np.radians(angle_deg))
    grey = 110 + 90 * np.sin(3 * along + 0.4)
    codes = np.repeat((shade * grey)[..., None], 3, axis=2).clip(0, 255).astype(np.uint8)
    number = next(_NUMBERS)
    codes[0, 0] = [number * 37 % 256, number * 11 % 256, number // 256 % 256]
    return codes


def jpeg(codes: U8) -> bytes:
    return bytes(simplejpeg.encode_jpeg(np.ascontiguousarray(codes), 95))


class FakeRig:
    """Devices in memory, and sessions on them.

    Attributes
    ----------
    paint : makes the next picture
    before : called before each exposure
    slip_deg : how far the table is turned on its shaft
    exposures : pictures taken so far
    acknowledged : told of each entry of a journal that is safe
    store : where the sessions' files go
    """

    def __init__(self, store: Store = DISK, *, lit: bool = True) -> None:
        self.store = store
        self.clock = FakeClock()
        self.turntable, self.arm, self.lights = FakeTurntable(), FakeArm(), FakeLights()
        self.slip_deg, self.exposures = 0.0, 0
        self.paint: Callable[[], bytes] = self.picture
        self.before: Callable[[], object] = lambda: None
        self.acknowledged: Callable[[Entry], object] = lambda _: None
        self.camera = FakeCamera(self._expose, self.clock)
        lamp = SpindleLampConfig(kind="grbl-spindle") if lit else None
        self.config = RigConfig(turntable=TurntableConfig(port="fake"), arm=ArmConfig(port="fake"), lights=lamp)

    def picture(self) -> bytes:
        """Show what the table bears, as far as the lamp lights it."""
        return jpeg(painted(self.turntable.angle_deg + self.slip_deg, 1.0 if self.lights.lamp is not None else 0.1))

    def capture(self, steps: Sequence[Step], folder: Path) -> bool:
        with self._in_place():
            return capture(self.config, StepsPlan(tuple(steps)), folder, SessionInfo("coin", note="on felt"))

    def resume(self, folder: Path, config: RigConfig | None = None, *, new_segment: bool = False) -> bool:
        with self._in_place():
            return resume(folder, config, new_segment=new_segment)

    def retake(self, folder: Path, *steps: int) -> bool:
        with self._in_place():
            return retake(folder, steps)

    def _expose(self) -> bytes:
        self.before()
        self.exposures += 1
        return self.paint()

    def _open(self, config: RigConfig, **_: object) -> Rig:
        return Rig(
            config,
            clock=self.clock,
            turntable=self.turntable,
            arm=self.arm,
            lights=self.lights,
            camera=self.camera,
        )

    @contextmanager
    def _in_place(self) -> Iterator[None]:
        """Let sessions open this rig, and write to this store."""
        rig = self

        class Writer(CaptureFolderWriter):
            @classmethod
            def create(cls, *args: Any, **options: Any) -> Self:
                return super().create(*args, **{**options, "store": rig.store})

            @classmethod
            def reopen(cls, folder: Path, lock: FolderLock, **options: Any) -> Self:
                return super().reopen(folder, lock, **{**options, "store": rig.store})

            def record(self, event: str, **fields: Any) -> Entry:
                entry = super().record(event, **fields)
                rig.acknowledged(entry)
                return entry

        with (
            patch("acquisition.session.open_rig", self._open),
            patch("acquisition.session.CaptureFolderWriter", Writer),
            patch("rig.drivers.entry_points", _ENTRY_POINTS),  # else each session searches all that is installed
        ):
            yield
