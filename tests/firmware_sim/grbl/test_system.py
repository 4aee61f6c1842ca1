"""`$` commands about the firmware itself."""

from tests.firmware_sim.grbl.host import BANNER, UNLOCK, Host


def test_settings_and_places_survive_the_loss_of_power_and_the_position_does_not() -> None:
    host = Host.homed()
    host.type("$110=3000\nG10 L2 P2 X-5\nG0 X-40\n")
    host.wait(10)
    true_place = host.true_place()
    host.arm.lose_power(0.3)
    assert host.type("?$$\n") == ""
    assert host.wait(0.4) == BANNER + UNLOCK
    assert "$110=3000.000\r\n" in host.type("$$\n")
    assert "[G55:-5.000,0.000,0.000]" in host.type("$#\n")
    assert host.place() == (0, 0, 0)
    assert host.true_place() == true_place


def test_startup_lines_run_after_each_start() -> None:
    host = Host.homed()
    assert host.type("$N0=G20\n") == "ok\r\n"
    assert host.type("$N\n") == "$N0=G20\r\n$N1=\r\nok\r\n"
    assert host.type("\x18") == BANNER + ">G20:ok\r\n"
    assert "G20" in host.type("$G\n")


def test_startup_lines_wait_for_an_unlocked_machine() -> None:
    host = Host()
    host.hear()
    assert host.type("$N0=G20\n") == "error:8\r\n"


def test_restoring_brings_back_what_was_delivered() -> None:
    host = Host.homed()
    host.type("$110=3000\nG10 L2 P1 X-5\n")
    assert host.type("$RST=$\n") == "[MSG:Restoring defaults]\r\nok\r\n" + BANNER
    assert "$110=7200.000" in host.type("$$\n")
    assert "[G54:-5.000" in host.type("$#\n")
    host.type("$RST=*\n")
    assert "[G54:0.000" in host.type("$#\n")


def test_check_mode_reads_lines_and_moves_nothing() -> None:
    host = Host.homed()
    assert host.type("$C\n") == "[MSG:Enabled]\r\nok\r\n"
    assert host.state() == "Check"
    assert host.type("G1 X-50 F100 M3 S1000\nG1 X\n") == "ok\r\nerror:2\r\n"
    host.wait(5)
    assert (host.place()[0], host.arm.lamp.power) == (-1, 0)
    assert host.type("$C\n") == "[MSG:Disabled]\r\nok\r\n" + BANNER
    assert host.state() == "Idle"


def test_sleep_ends_in_an_alarm() -> None:
    host = Host.homed()
    host.type("M3 S1000\n")
    assert host.type("$SLP\n") == "[MSG:Sleeping]\r\nok\r\n"
    assert (host.state(), host.arm.lamp.power) == ("Sleep", 0)
    assert host.type("G0 X-5\n~") == ""
    assert host.type("\x18") == BANNER + UNLOCK
    assert host.state() == "Alarm"


def test_build_info_is_kept() -> None:
    host = Host.homed()
    host.type("$I=arm 1\n")
    assert "[VER:1.1h.20190830:ARM1]" in host.type("$I\n")


def test_the_program_end_resets_the_modes_and_darkens() -> None:
    host = Host.homed()
    host.type("G91 G55 M3 S1000\n")
    assert host.type("M30\n") == "[MSG:Pgm End]\r\nok\r\n"
    assert host.arm.lamp.power == 0
    assert "G1 G54 G17 G21 G90" in host.type("$G\n")


def test_a_program_stop_waits_for_a_resume() -> None:
    host = Host.homed()
    assert host.type("M0\n") == ""
    assert host.state() == "Hold:0"
    assert host.type("~") == "ok\r\n"


def test_questions_in_a_dwell_are_answered_in_its_steps() -> None:
    host = Host.homed()
    host.type("G4 P1\n")
    host.clock.pass_s(0.01)
    assert host.type("?") == ""
    assert host.wait(0.05).startswith("<Idle|")


def test_a_reset_ends_a_dwell_and_keeps_the_position() -> None:
    host = Host.homed()
    host.type("M3 S1000\nG4 P60\nM5\n")
    host.wait(1)
    assert host.arm.lamp.power == 1
    assert host.type("\x18") == BANNER
    assert (host.arm.lamp.power, host.state()) == (0, "Idle")
    assert host.place() == host.true_place()


def test_a_line_behind_a_dwell_darkens_the_lamp_with_nobody_there() -> None:
    host = Host.homed()
    assert host.type("M3 S1000\nG4 P2\nM5\n") == "ok\r\n"
    host.wait(1.9)
    assert host.arm.lamp.power == 1
    assert host.wait(0.2) == "ok\r\nok\r\n"
    assert host.arm.lamp.power == 0
