"""The servo over its bytes, with the clock in our hands."""

from collections.abc import Callable

import pytest

from firmware_sim.dynamixel.control_table import ACCELERATION_UNIT_DEG_S2, VELOCITY_UNIT_DEG_S, Register
from firmware_sim.dynamixel.faults import Delay, FlipBit, Mute
from firmware_sim.dynamixel.packets import BROADCAST, Instruction, PacketReader, build, crc16
from tests.firmware_sim.dynamixel.host import Host, counts, parse


def test_a_ping_tells_the_model() -> None:
    (status,) = Host().send(1, Instruction.PING)
    assert (status.error, status.parameters[:2]) == (0, (1060).to_bytes(2, "little"))


def test_a_broadcast_ping_is_answered_by_all() -> None:
    assert [status.servo_id for status in Host(3, 1).send(BROADCAST, Instruction.PING)] == [1, 3]


def test_a_stranger_is_not_answered() -> None:
    assert Host().send(9, Instruction.PING) == []


def test_a_reply_waits_for_the_return_delay() -> None:
    host = Host()
    assert host.bus.feed(build(1, Instruction.PING, b"")) == b""
    assert host.bus.due_s() == pytest.approx(host.clock.now_s + 0.0005)
    host.clock.pass_s(0.0005)
    assert len(parse(host.bus.feed(b""))) == 1
    assert host.bus.due_s() is None


def test_positions_below_zero_are_signed() -> None:
    host = Host(start_deg=-43.95)
    host.torque_on()
    assert host.read(132) == -500 + 4096  # a servo that has just been switched on knows its place within one turn
    assert host.write(116, -500) == 0
    host.clock.pass_s(10)
    assert host.read(132) == -500


def test_the_table_is_half_way_after_half_the_time() -> None:
    host = Host()
    host.torque_on()
    host.write(108, 28)
    host.write(112, 66)
    host.write(116, counts(90))
    started_s = host.clock.now_s - 0.001
    speed, acceleration = 66 * VELOCITY_UNIT_DEG_S, 28 * ACCELERATION_UNIT_DEG_S2
    whole_s = 90 / speed + speed / acceleration
    host.clock.now_s = started_s + whole_s / 2
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(45, abs=0.01)
    assert (host.read(122, 1), host.read(123, 1) & 3) == (1, 2)
    assert host.read(128) == 66
    host.clock.now_s = started_s + whole_s + 0.01
    assert (host.read(122, 1), host.read(123, 1) & 3) == (0, 1)
    assert host.read(132) == counts(90)


def test_where_the_table_was_is_known_for_a_while() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(116, counts(90))
    before_s = host.clock.now_s
    host.clock.pass_s(5)
    assert 0 <= host.servo.angle_deg(before_s) < 1
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(90, abs=0.05)


def test_a_homing_offset_shifts_positions_and_goals_alike() -> None:
    host = Host(start_deg=90)
    assert host.write(20, 1000) == 0
    host.torque_on()
    assert host.read(132) == 1024 + 1000
    host.write(116, 1000)
    host.clock.pass_s(10)
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(0)


def test_torque_off_stops_a_move() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(116, 4096)
    host.clock.pass_s(1)
    host.write(64, 0)
    stopped_deg = host.servo.angle_deg(host.clock.now_s)
    host.clock.pass_s(9)
    assert 30 < host.servo.angle_deg(host.clock.now_s) == stopped_deg < 120


def test_torque_on_makes_no_jump() -> None:
    host = Host(start_deg=77)
    host.write(116, 0)
    host.torque_on()
    host.clock.pass_s(5)
    assert host.servo.angle_deg(host.clock.now_s) == 77


REFUSALS: list[tuple[Callable[[Host], int], int]] = [
    (lambda host: host.write(7, 5), 7),
    (lambda host: host.write(116, 5000), 6),
    (lambda host: host.write(65, 2), 4),
    (lambda host: host.write(70, 0), 7),
    (lambda host: host.send(1, Instruction.WRITE, b"\x74\x00\x01\x02")[0].error, 5),
    (lambda host: host.send(1, Instruction.WRITE, b"\x42\x00\x01")[0].error, 7),
    (lambda host: host.send(1, Instruction.READ, b"\x90\x01\x04\x00")[0].error, 4),
    (lambda host: host.send(1, 0x77)[0].error, 2),
    (lambda host: host.send(1, Instruction.ACTION)[0].error, 1),
]
REASONS = (
    "EEPROM is locked while torque is on",
    "a goal beyond the position limits",
    "a value beyond the register's range",
    "a register that is only read",
    "half a goal",
    "a place without a register",
    "reading behind the table",
    "an instruction that nobody knows",
    "an action that was not registered",
)


@pytest.mark.parametrize(("attempt", "error"), REFUSALS, ids=REASONS)
def test_a_refused_write_has_its_error_code_and_changes_nothing(attempt: Callable[[Host], int], error: int) -> None:
    host = Host(start_deg=10)
    host.torque_on(mode=3)
    before = host.servo.read(0, 120)
    assert attempt(host) == error
    host.clock.pass_s(5)
    assert host.servo.read(0, 120) == before
    assert host.servo.angle_deg(host.clock.now_s) == 10


def test_a_broken_packet_is_answered_with_a_crc_error() -> None:
    host = Host()
    damaged = bytearray(build(1, Instruction.PING, b""))
    damaged[-1] ^= 1
    host.bus.feed(bytes(damaged))
    host.clock.pass_s(0.001)
    (status,) = parse(host.bus.feed(b""))
    assert status.error == 3


@pytest.mark.parametrize(
    ("level", "answered"),
    [
        pytest.param(0, {"ping"}, id="level 0: ping alone"),
        pytest.param(1, {"ping", "read"}, id="level 1: reads too"),
        pytest.param(2, {"ping", "read", "write"}, id="level 2: everything"),
    ],
)
def test_the_status_return_level_decides_who_is_answered(level: int, answered: set[str]) -> None:
    host = Host()
    host.send(1, Instruction.WRITE, bytes([68, 0, level]))
    replies = {
        "ping": host.send(1, Instruction.PING),
        "read": host.send(1, Instruction.READ, b"\x84\x00\x04\x00"),
        "write": host.send(1, Instruction.WRITE, b"\x41\x00\x01"),
    }
    assert {name for name, reply in replies.items() if reply} == answered


def test_a_registered_write_waits_for_the_action() -> None:
    host = Host()
    host.send(1, Instruction.REG_WRITE, b"\x41\x00\x01")
    assert (host.read(65, 1), host.read(69, 1)) == (0, 1)
    host.send(BROADCAST, Instruction.ACTION)
    assert (host.read(65, 1), host.read(69, 1)) == (1, 0)


def test_a_reboot_clears_what_is_not_eeprom_and_takes_a_moment() -> None:
    host = Host(start_deg=400)
    host.torque_on()
    host.write(112, 66)
    host.send(1, Instruction.REBOOT)
    assert host.send(1, Instruction.PING) == []
    host.clock.pass_s(0.3)
    assert (host.read(64, 1), host.read(112), host.read(11, 1)) == (0, 0, 4)
    assert host.read(132) == counts(40)


def test_a_reboot_in_motion_stops_the_motor() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(116, 8192)
    host.clock.pass_s(1)
    host.send(1, Instruction.REBOOT)
    stopped_deg = host.servo.angle_deg(host.clock.now_s)
    host.clock.pass_s(5)
    assert host.servo.angle_deg(host.clock.now_s) == stopped_deg < 200


def test_clear_forgets_whole_turns() -> None:
    host = Host()
    host.torque_on()
    host.write(116, 4096 * 3 + 100)
    host.clock.pass_s(20)
    host.send(1, Instruction.CLEAR, b'\x01DXL"')
    assert host.read(132) == 100


def test_sync_and_bulk_instructions_reach_each_servo() -> None:
    host = Host(1, 2)
    assert host.send(BROADCAST, Instruction.SYNC_WRITE, b"\x41\x00\x01\x00" + b"\x01\x01" + b"\x02\x00") == []
    replies = host.send(BROADCAST, Instruction.SYNC_READ, b"\x41\x00\x01\x00\x01\x02")
    assert [(reply.servo_id, reply.value) for reply in replies] == [(1, 1), (2, 0)]
    host.send(BROADCAST, Instruction.BULK_WRITE, b"\x02\x41\x00\x01\x00\x01")
    replies = host.send(BROADCAST, Instruction.BULK_READ, b"\x02\x41\x00\x01\x00" + b"\x01\x84\x00\x04\x00")
    assert [(reply.servo_id, len(reply.parameters)) for reply in replies] == [(2, 1), (1, 4)]
    assert replies[0].value == 1


def test_a_fast_sync_read_is_one_packet_with_a_running_crc() -> None:
    host = Host(1, 2)
    host.bus.feed(build(BROADCAST, Instruction.FAST_SYNC_READ, b"\x84\x00\x04\x00\x01\x02"))
    host.clock.pass_s(0.001)
    said = host.bus.feed(b"")
    assert len(said) == 8 + 2 * 8
    assert (said[9], said[17]) == (1, 2)
    for end in (14, 22):
        assert crc16(said[:end]) == int.from_bytes(said[end : end + 2], "little")


def test_a_hardware_error_alerts_takes_torque_and_stays_until_reboot() -> None:
    host = Host()
    host.torque_on()
    host.servo.fail_hardware(0b10_0000)
    (status,) = host.send(1, Instruction.PING)
    assert status.error == 0x80
    assert (host.read(70, 1), host.read(64, 1)) == (0b10_0000, 0)
    assert host.write(64, 1) == 0x81
    host.send(1, Instruction.REBOOT)
    host.clock.pass_s(0.3)
    assert host.write(64, 1) == 0


def test_a_stalled_table_does_not_arrive_until_it_is_let_go() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(116, 1024)
    host.clock.pass_s(0.5)
    host.servo.stall(stalled=True)
    host.clock.pass_s(5)
    assert host.read(132) < 1000
    assert (host.read(122, 1), host.read(123, 1) & 1, host.read(128)) == (0, 0, 0)
    host.servo.stall(stalled=False)
    host.clock.pass_s(5)
    assert host.read(132) == 1024


def test_the_bus_watchdog_stops_a_table_that_nobody_watches() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(98, 5)
    host.write(116, 8192)
    for _ in range(20):
        host.clock.pass_s(0.05)
        host.read(132)
    under_way = host.read(132)
    host.clock.pass_s(0.2)
    host.bus.feed(b"")
    tripped_deg = host.servo.angle_deg(host.clock.now_s)
    host.clock.pass_s(3)
    assert host.read(Register.BUS_WATCHDOG, 1) == -1
    assert host.servo.angle_deg(host.clock.now_s) == tripped_deg > under_way * 360 / 4096
    assert host.write(116, 0) == 4
    assert host.write(98, 0) == 0
    assert host.write(116, 0) == 0


def test_muted_replies_are_lost_and_the_next_one_comes() -> None:
    host = Host()
    host.bus.faults.add(Mute(), 2)
    assert [len(host.send(1, Instruction.PING)) for _ in range(3)] == [0, 0, 1]


def test_a_late_reply_comes_after_the_answer_to_the_next_question() -> None:
    host = Host()
    host.bus.faults.add(Delay(0.1), 1)
    assert host.send(1, Instruction.READ, b"\x90\x00\x02\x00") == []
    assert len(host.send(1, Instruction.PING)) == 1
    host.clock.pass_s(0.1)
    (late,) = parse(host.bus.feed(b""))
    assert late.value == 120


def test_a_flipped_bit_breaks_the_packet() -> None:
    host = Host()
    host.bus.faults.add(FlipBit(75), 1)
    host.bus.feed(build(1, Instruction.PING, b""))
    host.clock.pass_s(0.001)
    (packet,) = PacketReader().feed(host.bus.feed(b""))
    assert not packet.intact
