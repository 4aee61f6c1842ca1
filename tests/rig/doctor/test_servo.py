"""What the doctor sees of a servo, on the simulator's own state machine."""

from pathlib import Path

import pytest

from firmware_sim.dynamixel.control_table import Register
from firmware_sim.dynamixel.faults import Delay, FlipBit, Mute
from rig.config import TurntableConfig
from rig.doctor.bench import Bench
from rig.doctor.finding import Finding, State
from rig.doctor.servo import check_servo
from rig.fakes import FakeClock
from tests.rig.doctor.far_ends import TABLE, Silence, Together, bench, bus, by_name, controller, servo


@pytest.fixture
def clock() -> FakeClock:
    return FakeClock(100.0)


def examined(found: Bench, **changes: object) -> dict[str, Finding]:
    config = TurntableConfig.model_validate({"port": "/dev/ttyTABLE", **changes})
    return by_name(list(check_servo(found, config)))


def test_a_healthy_servo_is_all_ok_and_has_not_moved(clock: FakeClock, tmp_path: Path) -> None:
    one = servo(clock)
    findings = examined(bench(clock, bus(clock, one), tmp_path, TABLE))
    assert {finding.state for finding in findings.values()} == {State.OK}
    assert list(findings) == ["port", "model", "firmware", "id", "hardware error", "temperature", "voltage"]
    assert one.angle_deg(clock.now_s()) == 30.0
    assert one.memory[Register.TORQUE_ENABLE] == 0
    assert clock.now_s() < 103.6


@pytest.mark.parametrize("baud", [9_600, 115_200, 1_000_000, 4_000_000])
@pytest.mark.parametrize("servo_id", [1, 42])
def test_another_baud_rate_is_found_and_named_in_time(
    clock: FakeClock, tmp_path: Path, baud: int, servo_id: int
) -> None:
    findings = examined(bench(clock, bus(clock, servo(clock, servo_id, baud)), tmp_path, TABLE))
    assert findings["baud"].state is State.FAULT
    assert f"answers at {baud} baud, RIG.toml says 57600" in findings["baud"].what
    assert findings["baud"].next_step.startswith(f"set baud = {baud} in [turntable]")
    assert clock.now_s() < 103.6


def test_another_id_is_found_and_named(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(bench(clock, bus(clock, servo(clock, 7)), tmp_path, TABLE))
    assert findings["id"].what == "no servo has id 1; there is id 7"
    assert findings["id"].next_step.startswith("set id = 7")


def test_two_servos_of_one_id_collide(clock: FakeClock, tmp_path: Path) -> None:
    both = Together(bus(clock, servo(clock, at_deg=30.0)), bus(clock, servo(clock, at_deg=77.0)))
    findings = examined(bench(clock, both, tmp_path, TABLE))
    assert findings["id"].state is State.FAULT
    assert "two servos have this id" in findings["id"].what
    assert "unplug all servos but one" in findings["id"].next_step


def test_two_servos_of_one_id_that_answer_one_after_the_other_collide(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(bench(clock, bus(clock, servo(clock), servo(clock, at_deg=77.0)), tmp_path, TABLE))
    assert findings["id"].state is State.FAULT
    assert "doubled" in findings["id"].what


def test_answers_that_are_all_damaged_are_no_silence(clock: FakeClock, tmp_path: Path) -> None:
    wire = bus(clock, servo(clock))
    wire.faults.add(FlipBit(70), 1000)
    findings = examined(bench(clock, wire, tmp_path, TABLE))
    assert findings["id"].state is State.FAULT
    assert "all answers at 57600 baud are damaged" in findings["id"].what


def test_a_few_lost_answers_are_asked_for_again(clock: FakeClock, tmp_path: Path) -> None:
    wire = bus(clock, servo(clock))
    wire.faults.add(Mute(), 2)
    assert examined(bench(clock, wire, tmp_path, TABLE))["model"].state is State.OK


def test_late_answers_are_not_taken_for_a_second_servo(clock: FakeClock, tmp_path: Path) -> None:
    wire = bus(clock, servo(clock))
    wire.faults.add(Delay(0.07), 5)
    assert examined(bench(clock, wire, tmp_path, TABLE))["id"].state is State.OK


def test_other_servos_of_the_bus_are_told(clock: FakeClock, tmp_path: Path) -> None:
    wire = bus(clock, servo(clock), servo(clock, 3), servo(clock, 200))
    assert examined(bench(clock, wire, tmp_path, TABLE))["bus"].what == "other servos on the bus: id 3, 200"


def test_another_model_is_a_fault(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(bench(clock, bus(clock, servo(clock)), tmp_path, TABLE), model="XM430-W350")
    assert findings["model"].state is State.FAULT
    assert "is a XL430-W250, RIG.toml says XM430-W350" in findings["model"].what
    assert 'model = "XL430-W250"' in findings["model"].next_step


@pytest.mark.parametrize(
    ("register", "value", "name", "state", "what"),
    [
        (Register.PRESENT_TEMPERATURE, 65, "temperature", State.WARNING, "65 °C, its limit is 72"),
        (Register.PRESENT_TEMPERATURE, 75, "temperature", State.FAULT, "75 °C, its limit is 72"),
        (Register.PRESENT_INPUT_VOLTAGE, 55, "voltage", State.FAULT, "5.5 V, allowed are 6.0"),
        (Register.PRESENT_INPUT_VOLTAGE, 63, "voltage", State.WARNING, "6.3 V"),
        (Register.PRESENT_INPUT_VOLTAGE, 150, "voltage", State.FAULT, "15.0 V"),
        (Register.HARDWARE_ERROR_STATUS, 0b100100, "hardware error", State.FAULT, "overheating, overload"),
        (Register.STATUS_RETURN_LEVEL, 0, "registers", State.FAULT, "to pings and not to reads"),
    ],
)
def test_what_a_servo_says_of_itself_is_judged(
    clock: FakeClock, tmp_path: Path, register: Register, value: int, name: str, state: State, what: str
) -> None:
    one = servo(clock)
    one.memory[register] = value
    finding = examined(bench(clock, bus(clock, one), tmp_path, TABLE))[name]
    assert finding.state is state
    assert what in finding.what
    assert finding.next_step


def test_silence_says_what_was_tried(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(bench(clock, Silence(), tmp_path, TABLE))
    assert "no servo answers on /dev/ttyTABLE at 57600, 1000000," in findings["answer"].what
    assert clock.now_s() < 103.6


def test_a_controller_on_the_servos_port_means_swapped_ports(clock: FakeClock, tmp_path: Path) -> None:
    findings = examined(bench(clock, controller(clock), tmp_path, TABLE))
    assert findings["answer"].next_step == "swap the ports of [turntable] and [arm]"
