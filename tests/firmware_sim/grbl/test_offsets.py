"""Coordinates: what they count from, and who remembers."""

import pytest

from tests.firmware_sim.grbl.host import Host


def offset(host: Host) -> list[float]:
    """Ask until the report has the work offset."""
    for _ in range(40):
        for field in host.fields():
            if field.startswith("WCO:"):
                return [float(value) for value in field[4:].split(",")]
    raise AssertionError("no report had a work offset")


def test_a_work_offset_moves_the_origin_and_shows_in_the_next_report() -> None:
    host = Host.homed()
    offset(host)
    host.type("G10 L2 P1 X-100\n")
    assert "WCO:-100.000,0.000,0.000" in host.fields()
    host.type("G0 X20\n")
    host.wait(10)
    assert host.place()[0] == -80


def test_a_work_offset_may_be_set_by_where_the_arm_stands() -> None:
    host = Host.homed()
    host.type("G55 G10 L20 P0 X5\n")
    assert offset(host) == [-6, 0, 0]
    assert "[G55:-6.000,0.000,0.000]" in host.type("$#\n")
    assert "G55" in host.type("$G\n")


def test_work_positions_are_reported_if_asked_for() -> None:
    host = Host.homed()
    host.type("$10=0\nG10 L2 P1 X-100\n")
    assert host.fields()[1] == "WPos:99.000,-1.000,-1.000"


def test_a_shift_is_forgotten_by_a_reset_and_an_offset_is_not() -> None:
    host = Host.homed()
    host.type("G10 L2 P1 Y-40\nG92 X0\n")
    assert offset(host) == [-1, -40, 0]
    host.type("\x18")
    assert offset(host) == [0, -40, 0]


def test_a_shift_may_be_taken_back() -> None:
    host = Host.homed()
    host.type("G92 X7\nG92.1\n")
    assert offset(host) == [0, 0, 0]


@pytest.mark.parametrize(("store", "go"), [("G28.1", "G28"), ("G30.1", "G30")])
def test_a_stored_place_is_found_again(store: str, go: str) -> None:
    host = Host.homed()
    host.type(f"G0 X-50\n{store}\nG0 X-200\n{go}\n")
    host.wait(60)
    assert host.place()[0] == -50


def test_machine_coordinates_know_no_offset() -> None:
    host = Host.homed()
    host.type("G10 L2 P1 X-100\nG53 G0 X-30\n")
    host.wait(10)
    assert host.place()[0] == -30
