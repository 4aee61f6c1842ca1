"""$32=1: the output is a laser, which shines under G1 and never while the arm is held."""

import pytest

from tests.firmware_sim.grbl.host import Host


def host_with_laser() -> Host:
    host = Host.homed()
    host.type("$32=1\n")
    return host


@pytest.mark.parametrize(
    ("line", "power"),
    [
        pytest.param("M3 S1000", 0, id="under G0 it stays dark"),
        pytest.param("G1 F100 M3 S1000", 1, id="under G1 it shines at rest"),
        pytest.param("G1 F100 M4 S1000", 0, id="M4 is power by speed: dark at rest"),
        pytest.param("G1 F100 M3 S1000\nG0", 0, id="back to G0 darkens"),
    ],
)
def test_it_shines_under_g1(line: str, power: float) -> None:
    host = host_with_laser()
    host.type(line + "\n")
    assert host.arm.lamp.power == power


def test_it_is_dark_on_hold_and_shines_again_afterwards() -> None:
    host = host_with_laser()
    host.type("G1 X-61 F3600 M3 S1000\n")
    host.wait(0.4)
    assert host.arm.lamp.power == 1
    host.type("!")
    host.wait(0.3)
    assert (host.state(), host.arm.lamp.power) == ("Hold:0", 0)
    host.type("~")
    assert host.arm.lamp.power == 1


def test_a_spindle_goes_on_during_a_hold() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG1 X-61 F3600\n")
    host.wait(0.4)
    host.type("!")
    host.wait(0.3)
    assert (host.state(), host.arm.lamp.power) == ("Hold:0", 1)


def test_power_by_speed_shines_on_the_way_only() -> None:
    host = host_with_laser()
    host.type("G1 X-61 F3600 M4 S1000\n")
    host.wait(0.4)
    assert host.arm.lamp.power == 1
    host.wait(5)
    assert host.arm.lamp.power == 0
