"""Bytes that change speed and light while things go on."""

import pytest

from tests.firmware_sim.grbl.host import Host


def test_the_feed_changes_in_the_middle_of_a_move() -> None:
    host = Host.homed()
    host.type("G1 X-301 F3600\n")
    host.wait(1)
    assert host.fields()[3] == "FS:3600,0"
    host.type(b"\x91\x91\x93")
    host.wait(0.5)
    assert host.fields()[3] == "FS:4356,0"
    host.type(b"\x90")
    host.wait(0.5)
    assert host.fields()[3] == "FS:3600,0"
    host.wait(20)
    assert host.place()[0] == -301


def test_no_override_exceeds_what_the_axes_can() -> None:
    host = Host.homed()
    host.type("G1 X-301 F7200\n")
    host.type(b"\x91" * 20)
    host.wait(1)
    assert host.fields()[3] == "FS:7200,0"


def test_rapids_have_an_override_of_their_own() -> None:
    host = Host.homed()
    host.type(b"\x97")
    host.type("G0 X-301\n")
    host.wait(1)
    assert host.fields()[3] == "FS:1800,0"


def test_overrides_show_at_once_and_a_reset_takes_them_back() -> None:
    host = Host.homed()
    host.type("???")
    host.type(b"\x92\x96\x9a")
    assert "Ov:90,50,110" in host.fields()
    host.type("\x18?")
    assert "Ov:100,100,100" in host.fields()


def test_the_lamp_follows_the_spindle_override() -> None:
    host = Host.homed()
    host.type("M3 S1000\n")
    host.type(b"\x9b" * 5)
    assert host.arm.lamp.power == pytest.approx(0.5, abs=0.01)


def test_the_spindle_stops_in_a_hold_only() -> None:
    host = Host.homed()
    host.type("M3 S1000\n")
    host.type(b"\x9e")
    assert host.arm.lamp.power == 1
    host.type(b"!\x9e")
    assert host.arm.lamp.power == 0
    host.type(b"\x9e")
    assert host.arm.lamp.power == 1


def test_coolant_is_switched_by_lines_and_by_bytes() -> None:
    host = Host.homed()
    host.type("M7 M3 S10\n")
    host.type(b"\xa0")
    assert "M7 M8" in host.type("$G\n")
    assert any("A:SFM" in host.fields() for _ in range(12))
    host.type("M9\n")
    assert " M9 " in host.type("$G\n")
