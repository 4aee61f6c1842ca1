"""What the doctor sees of the machine: ports, adapters, disk, clock."""

from collections import namedtuple
from datetime import UTC, datetime
from pathlib import Path

import pytest

from rig.doctor.disk import check_disk
from rig.doctor.finding import Part, State
from rig.doctor.port import try_port
from rig.doctor.wall_clock import check_clock
from rig.errors import PortError
from rig.fakes import FakeClock
from tests.rig.doctor.far_ends import TABLE, Silence, bench

Usage = namedtuple("Usage", "total used free")


@pytest.mark.parametrize(("latency", "state"), [("16", State.WARNING), ("2", State.OK), ("1", State.OK)])
def test_an_adapter_that_dawdles_is_told(tmp_path: Path, latency: str, state: State) -> None:
    timer = tmp_path / "bus/usb-serial/devices/ttyTABLE/latency_timer"
    timer.parent.mkdir(parents=True)
    timer.write_text(f"{latency}\n")
    _, findings = try_port(bench(FakeClock(), Silence(), tmp_path, TABLE), Part("turntable"), "/dev/ttyTABLE", 57_600)
    (finding,) = (finding for finding in findings if finding.name == "latency")
    assert finding.state is state
    assert f"{latency} ms" in finding.what
    assert state is State.OK or str(timer) in finding.next_step


def test_the_lock_file_of_another_program_is_heeded_while_that_program_lives(tmp_path: Path) -> None:
    looked_at = bench(FakeClock(), Silence(), tmp_path, TABLE)
    (tmp_path / "LCK..ttyTABLE").write_text("      4711\n")
    assert try_port(looked_at, Part("turntable"), "/dev/ttyTABLE", 57_600)[0] is not None, "it is stale"
    (tmp_path / "4711").mkdir()
    (tmp_path / "4711/comm").write_text("minicom\n")
    port, (finding,) = try_port(looked_at, Part("turntable"), "/dev/ttyTABLE", 57_600)
    assert port is None
    assert "taken by process 4711, minicom" in finding.what


def test_a_refused_port_is_a_fault_with_its_next_step(tmp_path: Path) -> None:
    def refuse(path: str, baud: int) -> None:
        raise PortError(f"{path}: no such port; check cable and power")

    looked_at = bench(FakeClock(), Silence(), tmp_path, TABLE, open_port=refuse)
    port, (finding,) = try_port(looked_at, Part("turntable"), "/dev/ttyTABLE", 57_600)
    assert port is None
    assert (finding.what, finding.next_step) == ("/dev/ttyTABLE: no such port", "check cable and power")


def test_a_folder_is_tried_and_left_as_it_was(tmp_path: Path) -> None:
    writing, room = check_disk(tmp_path)
    assert (writing.state, room.name) == (State.OK, "room")
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_yet_to_be_made_lies_on_the_disk_of_the_one_above(tmp_path: Path) -> None:
    writing, _ = check_disk(tmp_path / "sessions" / "today")
    assert str(tmp_path) in writing.what
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("free", "state"), [(3e8, State.FAULT), (3e9, State.WARNING), (3e11, State.OK)])
def test_a_disk_that_is_too_small_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, free: float, state: State
) -> None:
    monkeypatch.setattr("shutil.disk_usage", lambda _: Usage(int(1e12), 0, int(free)))
    assert list(check_disk(tmp_path))[1].state is state


def test_a_place_that_is_no_folder_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (finding,) = check_disk(tmp_path / "file")
    assert finding.state is State.FAULT
    assert "cannot be written" in finding.what


def test_a_clock_from_before_the_installation_is_told() -> None:
    (late,) = check_clock(lambda: datetime(2001, 1, 1, tzinfo=UTC))
    (now,) = check_clock()
    assert late.state is State.WARNING
    assert "2001-01-01" in late.what
    assert now.state is State.OK
