"""What the servo's manual says beyond moving about: reset, ids, drive modes, watchdog."""

import pytest

from firmware_sim.dynamixel.control_table import Register
from firmware_sim.dynamixel.packets import Instruction, build
from tests.firmware_sim.dynamixel.host import Host, counts


def test_a_tripped_watchdog_takes_no_goal_of_any_kind_until_it_is_cleared() -> None:
    host = Host()
    host.torque_on()
    host.write(98, 1)
    host.clock.pass_s(0.1)
    host.bus.feed(b"")
    for place, content in ((116, bytes(4)), (104, bytes(4)), (100, bytes(2)), (98, b"\x05")):
        (status,) = host.send(1, Instruction.WRITE, place.to_bytes(2, "little") + content)
        assert status.error == 4
    assert host.write(98, 0) == 0
    assert host.write(116, 0) == 0


@pytest.mark.parametrize(
    ("option", "kept"),
    [
        pytest.param(0xFF, {"id": 1, "baud": 1, "mode": 3}, id="everything"),
        pytest.param(0x01, {"id": 7, "baud": 1, "mode": 3}, id="all but the id"),
        pytest.param(0x02, {"id": 7, "baud": 3, "mode": 3}, id="all but id and baud rate"),
    ],
)
def test_a_factory_reset_leaves_what_its_option_says(option: int, kept: dict[str, int]) -> None:
    host = Host(7)
    for register, value in ((Register.BAUD_RATE, 3), (Register.OPERATING_MODE, 4), (Register.MODEL_NUMBER, 1020)):
        host.servo.memory[register] = value
    assert host.send(7, Instruction.FACTORY_RESET, bytes([option]))[0].error == 0
    memory = host.servo.memory
    found = {"id": memory[Register.ID], "baud": memory[Register.BAUD_RATE], "mode": memory[Register.OPERATING_MODE]}
    assert found == kept
    assert memory[Register.MODEL_NUMBER] == 1020


def test_a_factory_reset_without_a_known_option_is_refused() -> None:
    host = Host()
    assert host.send(1, Instruction.FACTORY_RESET, b"\x05")[0].error == 4
    assert host.send(1, Instruction.FACTORY_RESET)[0].error == 4


def test_a_servo_obeys_its_secondary_id_and_says_nothing() -> None:
    host = Host()
    host.send(1, Instruction.WRITE, bytes([12, 0, 20]))
    assert host.send(20, Instruction.WRITE, b"\x41\x00\x01") == []
    assert host.read(65, 1) == 1


def test_a_reversed_servo_counts_the_other_way() -> None:
    host = Host()
    host.send(1, Instruction.WRITE, bytes([10, 0, 1]))
    host.torque_on()
    host.write(116, 1024)
    host.clock.pass_s(5)
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(-90)
    assert host.read(132) == 1024


def test_a_time_based_profile_arrives_on_time() -> None:
    host = Host()
    host.send(1, Instruction.WRITE, bytes([10, 0, 4]))
    host.torque_on()
    host.write(112, 2000)
    host.write(108, 500)
    host.write(116, counts(90))
    started_s = host.clock.now_s - 0.001
    host.clock.now_s = started_s + 1.0
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(45, abs=0.1)
    host.clock.now_s = started_s + 1.9
    assert host.read(122, 1) == 1
    host.clock.now_s = started_s + 2.01
    assert (host.read(122, 1), host.read(132)) == (0, counts(90))


def test_a_goal_may_switch_torque_on() -> None:
    host = Host()
    host.send(1, Instruction.WRITE, bytes([10, 0, 8]))
    host.write(116, 512)
    host.clock.pass_s(5)
    assert (host.read(64, 1), host.read(132)) == (1, 512)


def test_a_packet_that_breaks_off_is_forgotten_after_a_pause() -> None:
    host = Host()
    host.bus.feed(build(1, Instruction.PING, b"")[:-1])
    host.clock.pass_s(0.11)
    assert len(host.send(1, Instruction.PING)) == 1
