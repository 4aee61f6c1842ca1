"""grblHAL, as far as it differs."""

from firmware_sim.grbl.dialect import GRBL_HAL
from tests.firmware_sim.grbl.host import Host

START = (-100.0, -30.0, -5.0, 12.0)


def four_axes() -> Host:
    host = Host(START, GRBL_HAL, (360, 90, 10, 0))
    host.hear()
    host.type("$H\n")
    host.wait(60)
    return host


def report(host: Host) -> str:
    return host.type("?") + host.wait(0.021)


def test_it_names_itself() -> None:
    assert Host(dialect=GRBL_HAL).hear().startswith("\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n")


def test_reports_come_in_frames_and_have_fields_of_their_own() -> None:
    host = Host.homed(GRBL_HAL)
    host.clock.pass_s(0.005)
    assert host.type("?") == ""
    assert "|Bf:100,1023|" in host.wait(0.02)
    assert "|A:|H:1|T:0|TLR:0>" in report(host)


def test_an_axis_that_does_not_home_keeps_its_count() -> None:
    host = four_axes()
    host.type("G0 A30\n")
    host.wait(5)
    host.type("$H\n")
    host.wait(60)
    assert "MPos:-1.000,-1.000,-1.000,30.000|" in report(host)


def test_one_axis_may_home_alone() -> None:
    host = four_axes()
    host.type("G0 X-50 Y-40\n")
    host.wait(10)
    assert host.type("$HX\n") == ""
    assert host.wait(60) == "ok\r\n"
    assert "MPos:-1.000,-40.000,-1.000," in report(host)


def test_a_turning_axis_has_no_soft_limit() -> None:
    host = four_axes()
    assert host.type("G0 A500\n") == "ok\r\n"
    host.wait(20)
    assert host.true_place()[3] == 12 + 500


def test_soft_limits_wait_for_homing() -> None:
    host = Host(dialect=GRBL_HAL)
    host.hear()
    assert host.type("$X\nG0 X50\n").endswith("ok\r\n")
    assert host.wait(5) == ""
    assert "<Idle|MPos:50.000," in report(host)
    host.type("$H\n")
    host.wait(60)
    assert "ALARM:2" in host.type("G0 X50\n") + host.wait(5)


def test_a_setting_after_a_reset_hangs_it() -> None:
    host = Host.homed(GRBL_HAL)
    assert host.type("$110=5000\n") == "ok\r\n"
    host.type("\x18")
    assert host.type("$110=6000\n?\x18") == ""
    assert host.wait(60) == ""
    host.arm.lose_power(0.1)
    assert "GrblHAL" in host.wait(0.2)
