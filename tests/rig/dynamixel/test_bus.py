"""Several servos on one wire."""

import pytest

from firmware_sim.dynamixel.control_table import Register
from firmware_sim.dynamixel.faults import Mute
from firmware_sim.dynamixel.packets import Instruction
from rig.dynamixel import registers
from rig.dynamixel.bus import DynamixelBus, RefusedError
from rig.dynamixel.models import MODELS, name_of
from rig.errors import LinkTimeoutError, PortError
from rig.fakes import FakeClock
from tests.rig.dynamixel.wires import Bench


def instructions(bench: Bench) -> list[int]:
    return [content[7] for _, content in bench.stream.sent]


def test_a_scan_finds_everybody_and_who_he_is() -> None:
    assert Bench(3, 1, 17).bus.scan() == {1: (1060, 45), 3: (1060, 45), 17: (1060, 45)}


def test_servos_without_broadcast_are_found_one_by_one() -> None:
    bench = Bench(3, 1)
    bench.firmware.groups = False
    assert bench.bus.scan() == {}
    assert bench.bus.scan(likely=(1, 2, 3)) == {1: (1060, 45), 3: (1060, 45)}


def test_one_register_of_several_servos_is_read_at_once() -> None:
    bench = Bench(1, 2, start_deg=90)
    bench.servos[1].fail_hardware(1)
    found = bench.bus.read_each({1: registers.PRESENT_POSITION, 2: registers.PRESENT_POSITION})
    assert instructions(bench) == [Instruction.SYNC_READ]
    assert [int.from_bytes(reply.content, "little") for reply in found.values()] == [1024, 1024]
    assert [reply.alert for reply in found.values()] == [False, True], "alert bits are not lost in a group"


def test_different_registers_are_read_at_once_too() -> None:
    bench = Bench(1, 2, start_deg=90)
    found = bench.bus.read_each({2: registers.PRESENT_VOLTAGE, 1: registers.MOTION})
    assert instructions(bench) == [Instruction.BULK_READ]
    assert (len(found[1].content), int.from_bytes(found[2].content, "little")) == (registers.MOTION.size, 120)


def test_servos_that_know_no_groups_are_read_singly_and_not_asked_again() -> None:
    bench = Bench(1, 2, start_deg=90)
    bench.firmware.groups = False
    places = dict.fromkeys((1, 2), registers.PRESENT_POSITION)
    for _ in range(2):
        found = bench.bus.read_each(places)
        assert [int.from_bytes(reply.content, "little") for reply in found.values()] == [1024, 1024]
    assert instructions(bench) == [Instruction.SYNC_READ] + 4 * [Instruction.READ]


def test_a_reply_that_is_lost_in_a_group_is_asked_for_alone() -> None:
    bench = Bench(1, 2, start_deg=90)
    bench.firmware.faults.add(Mute(), 1)
    found = bench.bus.read_each(dict.fromkeys((1, 2), registers.PRESENT_POSITION))
    assert [int.from_bytes(reply.content, "little") for reply in found.values()] == [1024, 1024]


def test_several_goals_are_written_at_the_same_instant() -> None:
    bench = Bench(1, 2)
    bench.bus.write_each(registers.GOAL_POSITION, {1: 100, 2: 200})
    assert [servo.memory[Register.GOAL_POSITION] for servo in bench.servos] == [100, 200]
    assert instructions(bench) == [Instruction.SYNC_WRITE, Instruction.SYNC_READ]


def test_who_does_not_take_a_common_write_is_written_to_alone() -> None:
    bench = Bench(1, 2)
    bench.firmware.groups = False
    bench.bus.write_each(registers.GOAL_POSITION, {1: 100, 2: 200})
    assert [servo.memory[Register.GOAL_POSITION] for servo in bench.servos] == [100, 200]


def test_a_refusal_counts_when_it_is_said_twice() -> None:
    bench = Bench()
    bench.bus.write(1, registers.TORQUE_ENABLE, 1)
    with pytest.raises(RefusedError, match="write operating mode: refused: the register is locked while torque is on"):
        bench.bus.write(1, registers.OPERATING_MODE, 4)
    assert instructions(bench) == 3 * [Instruction.WRITE]


def test_a_packet_that_was_damaged_on_its_way_is_sent_again() -> None:
    bench = Bench(start_deg=90)
    broken = [True]

    def break_once(content: bytes) -> bytes:
        return content[:-1] + bytes([content[-1] ^ 1]) if broken.pop() else content

    bench.stream.on_the_way_out = lambda content: break_once(content) if broken else content
    assert bench.bus.read(1, registers.PRESENT_VOLTAGE).content == (120).to_bytes(2, "little")
    assert len(bench.stream.sent) == 2


def test_a_reboot_is_answered_and_deafens_for_a_moment() -> None:
    bench = Bench()
    bench.bus.write(1, registers.PROFILE_VELOCITY, 50)
    bench.bus.reboot(1)
    bench.clock.sleep(0.3)
    assert bench.bus.read(1, registers.PROFILE_VELOCITY).content == bytes(4)


def test_silence_takes_three_tries_and_names_the_servo() -> None:
    bench = Bench()
    with pytest.raises(LinkTimeoutError, match="servo 9 on bench: no answer to ping after 3 tries"):
        bench.bus.ping(9)
    assert len(bench.stream.sent) == 3


def test_a_baud_rate_that_no_servo_has_is_refused() -> None:
    with pytest.raises(PortError, match=r"no servo has a baud rate of 1234; .* one of 9600, 57600"):
        DynamixelBus.open("/dev/ttyNOWHERE", 1234, FakeClock())


def test_models_have_names_and_numbers_of_their_own() -> None:
    assert len({model.name for model in MODELS}) == len({model.number for model in MODELS}) == len(MODELS)
    assert name_of(1060) == "XL430-W250"
    assert name_of(7) == "model number 7"
