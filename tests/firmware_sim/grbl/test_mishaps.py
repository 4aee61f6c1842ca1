"""What goes wrong with motors, switches, supply and cable."""

import pytest

from firmware_sim.grbl.config import GrblFaults
from firmware_sim.grbl.wire_faults import FaultyWire
from tests.firmware_sim.grbl.host import BANNER, UNLOCK, Host


def test_a_blocked_shaft_stays_where_it_is_and_nobody_notices() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    host.wait(0.5)
    before = host.true_place()[0]
    host.arm.block_shaft("X", blocked=True)
    host.wait(5)
    assert host.place()[0] == -61
    assert host.true_place()[0] == pytest.approx(before, abs=0.01)
    host.arm.block_shaft("X", blocked=False)
    host.type("G1 X-71 F3600\n")
    host.wait(5)
    assert host.true_place()[0] == pytest.approx(before - 10, abs=0.01)


def test_lost_steps_are_found_by_the_limit_switch_and_the_next_homing() -> None:
    host = Host.homed()
    host.type("$21=1\nG1 X-30 F3600\n")
    host.wait(5)
    host.arm.lose_steps("X", -10)
    assert host.place()[0] == -30
    assert host.true_place()[0] == pytest.approx(-20)
    host.type("G1 X-5 F600\n")
    assert "ALARM:1" in host.wait(5)
    host.wait(1)
    host.type("\x18$H\n")
    host.wait(60)
    assert host.place() == host.true_place()


def test_an_arm_too_far_behind_its_switch_cannot_be_homed() -> None:
    host = Host.homed()
    host.arm.lose_steps("X", -5)
    host.type("$H\n")
    assert host.wait(60).startswith("ALARM:8")


def test_a_hard_limit_in_motion_loses_the_position() -> None:
    host = Host.homed()
    host.type("$21=1\nM3 S1000\nG1 X-61 F3600\n")
    host.wait(0.3)
    host.arm.break_switches("stuck")
    assert host.hear() == "ALARM:1\r\n"
    host.wait(1)
    assert host.arm.lamp.power == 0
    host.type("\x18")
    assert host.place()[0] != pytest.approx(host.true_place()[0], abs=0.1)


def test_an_open_door_keeps_a_resume_from_working() -> None:
    host = Host.homed()
    host.type("G1 X-61 F3600\n")
    host.wait(0.4)
    host.arm.set_door(is_open=True)
    assert host.hear() == "[MSG:Check Door]\r\n"
    host.wait(0.5)
    assert "Pn:D" in host.fields()
    host.type("~")
    assert host.state() == "Door:1"
    host.arm.set_door(is_open=False)
    assert host.state() == "Door:0"
    host.type("~")
    host.wait(10)
    assert host.place()[0] == -61


def test_the_power_fails_in_the_middle_of_a_move() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG1 X-61 F3600\n")
    host.wait(0.5)
    host.arm.lose_power(0.2)
    stopped = host.true_place()
    assert host.arm.lamp.power == 0
    assert host.wait(0.3) == BANNER + UNLOCK
    assert host.state() == "Alarm"
    assert host.true_place() == stopped


def test_what_the_host_wrote_before_the_power_failed_is_forgotten() -> None:
    host = Host.homed()
    host.type("G4 P5\nG0 X-90\n")
    host.arm.lose_power(0.1)
    host.wait(10)
    assert host.true_place()[0] == -1


def wired(**shares: float) -> tuple[Host, FaultyWire]:
    host = Host.homed()
    return host, FaultyWire(host.arm, host.clock, GrblFaults.model_validate(shares))


def test_lines_get_lost() -> None:
    _, wire = wired()
    wire.mute = 2
    assert wire.feed(b"\n\n\n") == b"ok\r\n"


def test_lines_get_a_flipped_bit_and_keep_their_end() -> None:
    _, wire = wired()
    wire.garble = 20
    heard = wire.feed(b"\n" * 21).split(b"\r\n")
    assert heard[-2:] == [b"ok", b""]
    assert all(bin(int.from_bytes(line) ^ int.from_bytes(b"ok")).count("1") == 1 for line in heard[:20])


def test_lines_come_late_and_in_order() -> None:
    host, wire = wired()
    wire.delay, wire.delay_s = 1, 0.3
    assert wire.feed(b"\nG4 P0\nG99\n") == b""
    assert wire.due_s() == pytest.approx(host.clock.now_s + 0.3)
    host.clock.pass_s(0.3)
    assert wire.feed(b"") == b"ok\r\nok\r\nerror:20\r\n"


def test_lines_come_twice() -> None:
    _, wire = wired()
    wire.duplicate = 1
    assert wire.feed(b"\n\n") == b"ok\r\nok\r\nok\r\n"


def test_bytes_to_it_get_lost() -> None:
    _, wire = wired()
    wire.drop_heard(0)
    assert wire.feed(b"G99\n\n") == b"error:1\r\nok\r\n"
    wire.drop_heard(3, 1)
    assert wire.feed(b"G99\n\n") == b"error:20\r\n"


def test_shares_of_lines_and_bytes_are_struck_the_same_every_time() -> None:
    heard = [wired(mute=0.2, garble=0.2, seed=7)[1].feed(b"\n" * 50) for _ in range(2)]
    assert heard[0] == heard[1]
    assert 60 < len(heard[0]) < 196
