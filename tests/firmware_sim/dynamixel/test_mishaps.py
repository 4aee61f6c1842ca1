"""What befalls the servo's supply, its shaft, and the bytes on its wire."""

import pytest

from firmware_sim.dynamixel.config import TurntableFaults
from firmware_sim.dynamixel.control_table import Register
from firmware_sim.dynamixel.faults import DropByte, Duplicate, Foreign
from firmware_sim.dynamixel.packets import Instruction, PacketReader, build
from firmware_sim.dynamixel.table import Table
from tests.firmware_sim.dynamixel.host import Host, counts, parse


def test_a_brown_out_forgets_ram_and_turns_and_the_load_turns_the_shaft() -> None:
    host = Host()
    host.torque_on()
    host.write(112, 66)
    host.write(116, 4096 + 100)
    host.clock.pass_s(10)
    host.servo.brown_out(turned_deg=20)
    assert host.send(1, Instruction.PING) == []
    host.clock.pass_s(0.3)
    assert (host.read(64, 1), host.read(112), host.read(132)) == (0, 0, 100 + counts(20))


def test_a_servo_may_be_told_to_keep_torque_and_profile_through_a_reboot() -> None:
    host = Host()
    host.servo.memory[Register.STARTUP_CONFIGURATION] = 3
    host.torque_on()
    host.write(112, 66)
    host.send(1, Instruction.REBOOT)
    host.clock.pass_s(0.3)
    assert (host.read(64, 1), host.read(112)) == (1, 66)


def test_pushing_against_a_block_for_long_is_an_overload() -> None:
    host = Host()
    host.torque_on()
    host.servo.stall_at_deg, host.servo.overload_after_s = 30.0, 1.0
    host.write(112, 66)
    host.write(116, 1024)
    for _ in range(20):
        host.clock.pass_s(0.05)
        host.bus.feed(b"")
    assert host.servo.angle_deg(host.clock.now_s) == pytest.approx(30, abs=5)
    assert (host.read(70, 1), host.read(126, 2)) == (0, 1000)
    host.clock.pass_s(1)
    assert (host.read(70, 1), host.read(64, 1)) == (0b10_0000, 0)


def test_supply_and_temperature_beyond_their_limits_are_hardware_errors() -> None:
    host = Host()
    host.torque_on()
    host.servo.feel(volts=15.0)
    assert (host.read(144, 2), host.read(70, 1), host.read(64, 1)) == (150, 1, 1)
    host.servo.feel(deg_c=90)
    assert (host.read(146, 1), host.read(70, 1), host.read(64, 1)) == (90, 5, 0)


def test_an_overshoot_rings_down_to_the_goal() -> None:
    host = Host()
    host.servo.overshoot_deg = 2.0
    host.torque_on()
    host.write(112, 66)
    host.write(116, 1024)
    way = []
    for _ in range(200):
        host.clock.pass_s(0.01)
        way.append(host.servo.angle_deg(host.clock.now_s))
    assert max(way) == pytest.approx(92, abs=0.3)
    assert way[-1] == pytest.approx(90)


def test_a_table_with_play_lags_when_the_shaft_turns_up() -> None:
    host = Host()
    table = Table(host.servo, host.clock)
    table.play_deg, table.slip_deg = 1.5, 10.0
    host.torque_on()
    for goal, lag_deg in ((512, 1.5), (100, 0.0), (105, 105 * 360 / 4096 - 100 * 360 / 4096)):
        host.write(116, goal)
        host.clock.pass_s(5)
        table.advance()
        assert table.angle_deg(host.clock.now_s) == pytest.approx(goal * 360 / 4096 - lag_deg + 10)


def said(host: Host, question: bytes) -> bytes:
    """Return the bytes that come over the wire within a while, before anybody makes packets of them."""
    heard = host.bus.feed(question)
    host.clock.pass_s(0.05)
    return heard + host.bus.feed(b"")


PING = build(1, Instruction.PING, b"")


def test_a_lost_byte_shortens_the_reply() -> None:
    host = Host()
    whole = said(host, PING)
    host.bus.faults.add(DropByte(5), 1)
    assert said(host, PING) == whole[:5] + whole[6:]


def test_a_lost_byte_of_a_question_leaves_it_unanswered() -> None:
    host = Host()
    host.bus.faults.lose_heard(9, 1)
    assert said(host, PING) == b""
    host.clock.pass_s(0.1)
    assert said(host, PING) != b""


def test_a_copy_comes_when_it_is_told_to() -> None:
    host = Host()
    host.bus.faults.add(Duplicate(0.02), 1)
    assert len(parse(said(host, PING))) == 2


@pytest.mark.parametrize(("alone", "ids"), [(True, [2]), (False, [2, 1])])
def test_another_servo_speaks_before_or_instead(alone: bool, ids: list[int]) -> None:
    host = Host()
    host.bus.faults.add(Foreign(alone), 1)
    assert [status.servo_id for status in parse(said(host, PING))] == ids


def test_a_host_may_hear_itself() -> None:
    host = Host()
    host.bus.faults.echo = True
    assert said(host, PING).startswith(PING)


def test_two_servos_with_one_id_spoil_each_others_replies() -> None:
    host = Host()
    host.bus.faults.clash = True
    assert not any(packet.intact for packet in PacketReader().feed(said(host, PING)))


def test_shares_strike_so_many_replies_and_the_same_ones_with_the_same_seed() -> None:
    def lost(seed: int) -> list[int]:
        host = Host()
        host.bus.faults.spread(TurntableFaults(mute=0.2, seed=seed))
        return [n for n in range(500) if not said(host, PING)]

    assert 60 < len(lost(1)) < 140
    assert lost(1) == lost(1) != lost(2)
