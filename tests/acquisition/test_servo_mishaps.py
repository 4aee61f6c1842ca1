"""A session on a simulated servo to which something happens during an exposure: that frame never counts."""

import itertools
from collections.abc import Callable
from pathlib import Path

import pytest

from acquisition.plans import amc_plan
from acquisition.runner import run
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import read_journal
from litrig.base.capture_folder.writer import CaptureFolderWriter
from litrig.base.errors import HoldError
from rig.config import RigConfig, TurntableConfig
from rig.fakes import FakeCamera
from rig.rig import Rig, RigState
from tests.acquisition.test_session import picture
from tests.rig.dynamixel.wires import Bench

CASES: dict[str, tuple[Callable[[Bench], object], str, bool]] = {
    "power sag": (lambda bench: bench.servo.brown_out(), "position is lost; check the supply", False),
    "alert": (lambda bench: bench.servo.fail_hardware(1), "input voltage .* position is kept", True),
    "overload": (lambda bench: bench.servo.fail_hardware(32), "overload.*let go, its position is kept", True),
    "encoder": (lambda bench: bench.servo.fail_hardware(8), "encoder fault.* position is lost", False),
    "torque taken away": (lambda bench: bench.servo.write(64, b"\0"), "torque was switched off", True),
}


@pytest.mark.parametrize(("mishap", "message", "known"), CASES.values(), ids=CASES)
def test_what_befalls_the_servo_during_an_exposure_costs_that_frame_alone(
    tmp_path: Path, mishap: Callable[[Bench], object], message: str, known: bool
) -> None:
    bench, shots = Bench(), itertools.count()

    def paint() -> bytes:
        if next(shots) == 2:
            mishap(bench)
            bench.clock.sleep(0.3)
        return picture()

    rig = Rig(
        RigConfig(turntable=TurntableConfig(port="bench")),
        clock=bench.clock,
        turntable=bench.turntable(),
        camera=FakeCamera(paint, bench.clock),
    )
    with (
        pytest.raises(HoldError, match=message),
        CaptureFolderWriter.create(tmp_path / "s", "coin", {}, []) as writer,
        rig,
    ):
        list(run(amc_plan(8), rig, writer, lambda: False))
    entries = read_journal(tmp_path / "s" / layout.JOURNAL)
    assert [entry["step"] for entry in entries if entry["ev"] == "frame"] == [0, 1]
    assert rig.position_known is known
    assert rig.state is RigState.HOLD
