"""Sessions on devices in memory: what counts, what is retried, and what stops the rig."""

import errno
import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import simplejpeg

from acquisition.events import FrameTaken, Paused, RunEvent
from acquisition.plans import Plan, amc_plan, ptm_plan
from acquisition.room import Room
from acquisition.runner import check_plan, run
from acquisition.wanted import read_steps
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import Journal, read_journal
from litrig.base.capture_folder.verify import verify_capture
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import HoldError, InputError
from rig.config import ArmConfig, RigConfig, TurntableConfig
from rig.errors import LinkTimeoutError, OutOfRangeError, RigError
from rig.fakes import FakeArm, FakeCamera, FakeClock, FakeLights, FakeTurntable
from rig.interrupts import StopNow
from rig.rig import Rig, RigState
from tests.faults.disks import STEPS as SMALL
from tests.faults.disks import FullDisk
from tests.faults.fake_sessions import FakeRig

COUNTER = itertools.count()


def picture(brightness: int = 90) -> bytes:
    """Return a JPEG that no other is equal to."""
    codes = np.full((12, 16, 3), brightness, np.uint8)
    codes[0, 0] = [next(COUNTER) * 37 % 256, next(COUNTER) * 11 % 256, 128]
    return bytes(simplejpeg.encode_jpeg(codes, 95))


class Bench:
    """A rig of fakes, and the folder it writes to."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.clock = FakeClock()
        self.turntable, self.arm, self.lights = FakeTurntable(), FakeArm(), FakeLights()
        self.paint: Callable[[], bytes] = picture
        self.camera = FakeCamera(lambda: self.paint(), self.clock)
        config = RigConfig(turntable=TurntableConfig(port="fake"), arm=ArmConfig(port="fake"))
        self.rig = Rig(
            config,
            clock=self.clock,
            turntable=self.turntable,
            arm=self.arm,
            lights=self.lights,
            camera=self.camera,
        )

    def shoot(self, plan: Plan, pause: Callable[[], bool] = lambda: False) -> list[RunEvent]:
        with CaptureFolderWriter.create(self.folder, "coin", {}, []) as writer, self.rig:
            check_plan(plan, self.rig)
            return list(run(plan, self.rig, writer, pause))

    def journal(self, event: str) -> list[dict[str, object]]:
        return [entry for entry in read_journal(self.folder / layout.JOURNAL) if entry["ev"] == event]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path / "s")


def test_every_slice_is_shot_and_the_rig_parks(bench: Bench) -> None:
    events = bench.shoot(amc_plan(8))
    assert [event.step.step for event in events if isinstance(event, FrameTaken)] == list(range(8))
    frames = bench.journal("frame")
    assert [frame["pose_after"] for frame in frames] == [{"angle_deg": 45.0 * s} for s in range(8)]
    assert all(frame["verdict"] == "good" for frame in frames)
    assert bench.turntable.angle_deg == 0
    assert not bench.turntable.torque


def test_lights_are_lit_for_every_frame_and_dark_at_the_end(bench: Bench) -> None:
    lit: list[int | None] = []

    def watch() -> bytes:
        lit.append(bench.lights.lamp)
        return picture()

    bench.paint = watch
    bench.shoot(ptm_plan(6))
    assert lit == [0] * 6
    assert bench.lights.lamp is None
    light = bench.journal("frame")[0]["light"]
    assert isinstance(light, list)
    assert np.linalg.norm(light) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        pytest.param(lambda good: good[:-20], "damaged JPEG", id="cut short"),
        pytest.param(
            lambda good: bytes(simplejpeg.encode_jpeg(np.zeros((12, 16, 3), np.uint8))), "is black", id="black"
        ),
    ],
)
def test_a_bad_frame_is_shot_again_and_never_acknowledged(
    bench: Bench, spoil: Callable[[bytes], bytes], reason: str
) -> None:
    shots = itertools.count()
    bench.paint = lambda: spoil(picture()) if next(shots) == 2 else picture()
    bench.shoot(amc_plan(8))
    assert [frame["try"] for frame in bench.journal("frame")] == [1, 1, 2, 1, 1, 1, 1, 1]
    assert reason in str(bench.journal("retry")[0]["reason"])


def test_a_frozen_camera_stops_the_session_with_the_frames_so_far(bench: Bench) -> None:
    frozen = picture()
    bench.paint = lambda: frozen
    with pytest.raises(HoldError, match=r"step 0: after 3 tries .* the camera is frozen"):
        bench.shoot(amc_plan(8))
    assert [recall["steps"] for recall in bench.journal("recall")] == [[0]], "that picture may be of another pose"
    assert len(bench.journal("frame")) == 1
    assert len(bench.journal("hold")) == 1
    assert bench.rig.state is RigState.HOLD
    assert bench.turntable.torque, "a sample on a tilted table must not slip"


def test_a_table_that_is_off_its_pose_yields_no_frame(bench: Bench) -> None:
    bench.turntable.error_deg = 1.0
    with pytest.raises(HoldError, match=r"1\.00° off its pose"):
        bench.shoot(amc_plan(8))
    assert bench.journal("frame") == []


def test_a_silent_device_holds_the_rig(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def silent(angle_deg: float) -> None:
        raise LinkTimeoutError("servo 1: no answer")

    monkeypatch.setattr(bench.turntable, "move_to", silent)
    with pytest.raises(HoldError, match=r"no answer.*on hold"):
        bench.shoot(amc_plan(8))
    assert bench.turntable.stops > 0
    assert bench.lights.lamp is None


def test_a_plan_beyond_the_limits_is_refused_before_anything_moves(bench: Bench) -> None:
    bench.turntable.max_deg = 180
    with pytest.raises(OutOfRangeError, match="nothing moved"):
        bench.shoot(amc_plan(8))
    assert not bench.turntable.torque
    assert bench.journal("frame") == []


def test_a_pause_comes_after_the_step_and_keeps_the_rig_powered(bench: Bench) -> None:
    events = bench.shoot(amc_plan(8), lambda: bench.clock.now_s() > 0.025)
    assert events[-1] == Paused(3)
    assert len(bench.journal("frame")) == 3
    assert bench.turntable.torque
    assert bench.rig.state is RigState.PAUSED


def test_a_stop_in_the_middle_holds_and_keeps_what_was_shot(bench: Bench) -> None:
    shots = itertools.count()

    def stop_at_third() -> bytes:
        if next(shots) == 2:
            raise StopNow
        return picture()

    bench.paint = stop_at_third
    with pytest.raises(StopNow):
        bench.shoot(amc_plan(8))
    assert len(bench.journal("frame")) == 2
    assert len(bench.journal("stop")) == 1
    assert bench.turntable.stops > 0
    assert bench.turntable.torque


def test_a_rig_without_a_camera_says_so_before_it_moves(bench: Bench) -> None:
    rig = Rig(bench.rig.config, clock=bench.clock, turntable=bench.turntable)
    with pytest.raises(RigError, match="no camera"):
        check_plan(amc_plan(8), rig)


def test_a_full_disk_holds_the_rig(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes, **_: object) -> None:
        raise InputError(f"{path}: cannot be written (No space left on device); free space")

    with monkeypatch.context() as patch, pytest.raises(HoldError, match="No space left"):
        bench.folder.mkdir()
        with CaptureFolderWriter(bench.folder, Journal(bench.folder / "journal.jsonl"), "x") as writer, bench.rig:
            patch.setattr("litrig.base.capture_folder.writer.write_atomically", full)
            list(run(amc_plan(8), bench.rig, writer, lambda: False))
    assert bench.rig.state is RigState.HOLD


def test_a_homing_that_breaks_off_leaves_the_position_unknown(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    bench.rig.home()
    assert bench.rig.position_known

    def broken_off() -> None:
        raise StopNow

    monkeypatch.setattr(bench.arm, "home", broken_off)
    with pytest.raises(StopNow):
        bench.rig.home()
    assert not bench.rig.position_known


def test_a_folder_that_vanishes_between_two_frames_holds_the_rig(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(room: Room, frame_bytes: int, frames_left: int) -> None:
        raise FileNotFoundError(errno.ENOENT, "No such file or directory", str(bench.folder))

    monkeypatch.setattr(Room, "check", gone)
    with pytest.raises(HoldError, match=rf"{bench.folder}: No such file.*check the disk"):
        bench.shoot(amc_plan(8))
    assert bench.rig.state is RigState.HOLD
    assert len(bench.journal("hold")) == 1


def test_resuming_what_never_was_a_session_says_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "data" / "frames").mkdir(parents=True)
    with pytest.raises(InputError, match=r"holds no session .*ended before anything was shot.*capture anew"):
        read_steps(tmp_path)


def test_a_session_whose_bag_cannot_be_closed_says_that_its_frames_are_safe(tmp_path: Path) -> None:
    rig = FakeRig(FullDisk(10**6, 1))
    store = rig.store
    assert isinstance(store, FullDisk)
    folder = tmp_path / "s"

    def fill(entry: dict[str, object]) -> None:
        if entry["ev"] == "close":
            store.first = 0

    rig.acknowledged = fill
    with pytest.raises(InputError, match=rf"No space left.*Every frame is safe; litrig capture resume {folder} closes"):
        rig.capture(SMALL, folder)
    FakeRig().resume(folder)
    assert verify_capture(folder).findings == ()
