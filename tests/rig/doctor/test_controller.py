"""What the doctor sees of a GRBL controller, on the simulator's own state machine."""

from pathlib import Path

import pytest

from rig.doctor.controller import check_controller
from rig.doctor.finding import Finding, State
from rig.fakes import FakeClock
from tests.rig.doctor.far_ends import ARM, FarEnd, Silence, bench, bus, by_name, controller, servo


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock(100.0)


def examined(
    clock: FakeClock, far_end: FarEnd, tmp_path: Path, baud: int = 115_200, power: float = 1000.0
) -> dict[str, Finding]:
    lights = {"lights": {"kind": "grbl-spindle", "power": power}}
    return by_name(list(check_controller(bench(clock, far_end, tmp_path, ARM, lights), "arm", "/dev/ttyARM", baud)))


def test_a_healthy_controller_is_all_ok_and_has_not_moved(clock: FakeClock, tmp_path: Path) -> None:
    arm = controller(clock)
    findings = examined(clock, arm, tmp_path)
    assert {finding.state for finding in findings.values()} == {State.OK}
    assert findings["firmware"].what == "GRBL 1.1h.20190830"
    assert "until it is homed" in findings["state"].what
    assert findings["output"].part == "lights"
    assert arm.position(clock.now_s())[:2] == (-60.0, -35.0)
    assert clock.now_s() < 103.0


@pytest.mark.parametrize(
    ("settings", "name", "state", "next_step"),
    [
        pytest.param({"s22": 0, "s20": 0}, "homing", State.FAULT, "$22=1", id="no homing"),
        pytest.param({"s20": 0}, "soft limits", State.WARNING, "$20=1", id="no soft limits"),
        pytest.param({"s13": 1}, "units", State.FAULT, "$13=0", id="inches"),
        pytest.param({"s30": 255}, "power", State.WARNING, "255 at most, or send $30=1000", id="beyond the output"),
    ],
)
def test_settings_that_a_rig_cannot_live_with_are_told(
    clock: FakeClock, tmp_path: Path, settings: dict[str, float], name: str, state: State, next_step: str
) -> None:
    finding = examined(clock, controller(clock, **settings), tmp_path)[name]
    assert finding.state is state
    assert next_step in finding.next_step


def test_a_lamp_on_the_laser_output_is_as_good(clock: FakeClock, tmp_path: Path) -> None:
    finding = examined(clock, controller(clock, s32=1), tmp_path)["output"]
    assert (finding.state, "laser output" in finding.what) == (State.OK, True)


def test_a_controller_in_motion_is_told_and_not_asked_for_its_settings(clock: FakeClock, tmp_path: Path) -> None:
    arm = controller(clock, s22=0, s20=0)
    arm.feed(b"G1 X-300 F100\n")
    clock.sleep(0.5)
    findings = examined(clock, arm, tmp_path)
    assert "in state Run" in findings["state"].what
    assert "homing" not in findings


def test_an_open_door_is_a_fault(clock: FakeClock, tmp_path: Path) -> None:
    arm = controller(clock, s22=0, s20=0)
    arm.feed(b"\x84")
    assert "door" in examined(clock, arm, tmp_path)["state"].what


def test_a_wrong_baud_rate_is_found(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(clock, controller(clock), tmp_path, baud=57_600)
    assert findings["baud"].next_step == "set baud = 115200 in [arm]"


def test_a_servo_on_the_controllers_port_means_swapped_ports(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(clock, bus(clock, servo(clock)), tmp_path)
    assert findings["answer"].next_step == "swap the ports of [turntable] and [arm]"


def test_silence_is_told_in_time(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(clock, Silence(), tmp_path)
    assert "no GRBL controller answers on /dev/ttyARM at 115200 baud" in findings["answer"].what
    assert clock.now_s() < 103.6


class Dialect:
    """Answers to `?` and `$I` as another firmware does."""

    baud = 115_200

    def __init__(self, version: bytes) -> None:
        self._version = version

    def feed(self, content: bytes) -> bytes:
        answers = {b"?": b"<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n", b"$I\n": self._version + b"ok\r\n"}
        return answers.get(content, b"error:3\r\n" if content else b"")


@pytest.mark.parametrize(
    ("version", "state", "what"),
    [
        (b"[VER:1.1f.20240101:annabels rig]\r\n", State.OK, "GRBL 1.1f.20240101"),
        (b"[VER:3.7 FluidNC v3.7.16:]\r\n", State.OK, "FluidNC"),
        (b"[VER:0.9j.20160317:]\r\n", State.WARNING, "not GRBL 1.1"),
        (b"", State.WARNING, "does not say what it is"),
    ],
)
def test_firmwares_are_told_apart_and_their_owners_text_is_left_out(
    clock: FakeClock, tmp_path: Path, version: bytes, state: State, what: str
) -> None:
    findings = examined(clock, Dialect(version), tmp_path)
    assert findings["firmware"].state is state
    assert what in findings["firmware"].what
    assert "annabel" not in findings["firmware"].what
    assert findings["settings"].state is State.WARNING
