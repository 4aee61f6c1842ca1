"""All checks together: side by side, in time, and each part by what it is."""

import os
import threading
from contextlib import ExitStack
from pathlib import Path

import pytest
import serial

from rig.clock import MonotonicClock
from rig.config import RigConfig
from rig.doctor.bench import Bench
from rig.doctor.finding import Findings, Part, State
from rig.doctor.passive import checks_of, examine, run_side_by_side
from rig.errors import DeviceError
from rig.rig_lock import RigLock


def patient_bench(seconds: float, config: RigConfig | None = None) -> Bench:
    clock = MonotonicClock()
    return Bench(config or RigConfig(), clock.now_s() + seconds, clock=clock)


def test_what_hangs_is_told_with_what_it_said_before_and_hangs_nobody_else() -> None:
    never = threading.Event()
    closed: list[str] = []

    def hang(stack: ExitStack) -> Findings:
        stack.callback(closed.append, "camera")
        yield Part("camera").ok("settings", "fine")
        never.wait(60)

    def answer(_: ExitStack) -> Findings:
        yield Part("arm").ok("state", "idle")

    found = run_side_by_side(patient_bench(0.3), {"camera": hang, "arm": answer})
    never.set()
    assert [(finding.part, finding.name, finding.state) for finding in found] == [
        ("camera", "settings", State.OK),
        ("camera", "answer", State.FAULT),
        ("arm", "state", State.OK),
    ]
    assert "hangs" in found[1].what
    assert closed == ["camera"], "what it holds is given back"


@pytest.mark.parametrize(
    ("error", "what", "next_step"),
    [
        (DeviceError("servo 1: is hot; let it cool down"), "servo 1: is hot", "let it cool down"),
        (serial.SerialException("gone"), "went away (gone)", "check its cable and try again"),
    ],
)
def test_an_error_in_the_middle_is_a_finding(error: Exception, what: str, next_step: str) -> None:
    def fail(_: ExitStack) -> Findings:
        yield Part("turntable").ok("port", "opens")
        raise error

    found = run_side_by_side(patient_bench(5), {"turntable": fail})
    assert [finding.state for finding in found] == [State.OK, State.FAULT]
    assert (found[1].what, found[1].next_step) == (what, next_step)


def test_each_part_is_looked_at_once_and_by_its_kind() -> None:
    config = RigConfig.model_validate(
        {
            "turntable": {"port": "/dev/ttyA"},
            "arm": {"port": "/dev/ttyB"},
            "lights": {"kind": "grbl-spindle"},
            "camera": {"device": "/dev/video97"},
        }
    )
    assert list(checks_of(patient_bench(1, config))) == ["turntable", "arm", "camera", "disk", "clock"]


def test_a_rig_that_is_not_there_is_faults_with_next_steps(tmp_path: Path) -> None:
    config = RigConfig.model_validate(
        {
            "turntable": {"port": "/dev/ttyNOWHERE"},
            "lights": {"kind": "always-on"},
            "camera": {"device": "/dev/video97"},
        }
    )
    found = {(finding.part, finding.name): finding for finding in examine(config, tmp_path, patience_s=30)}
    assert found["turntable", "port"].what == "/dev/ttyNOWHERE: no such port"
    assert "cannot be opened as a camera" in found["camera", "picture"].what
    assert found["lights", "switching"].state is State.OK
    assert all(finding.next_step for finding in found.values() if finding.state is not State.OK)


def test_a_rig_in_use_is_left_alone_and_its_user_named(tmp_path: Path) -> None:
    config = RigConfig.model_validate({"turntable": {"port": "/dev/ttyNOWHERE"}})
    lock = RigLock(["/dev/ttyNOWHERE"])
    try:
        found = examine(config, tmp_path)
    finally:
        lock.release()
    assert f"in use by litrig, process {os.getpid()}" in found[0].what
    assert {finding.part for finding in found} == {"rig", "disk", "clock"}
