"""What goes over the wires is written down, and a record stands in for the devices."""

import json
import os
import select
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from firmware_sim.launch import RunningSim
from litrig.base.errors import FormatError, InputError
from rig.clock import MonotonicClock
from rig.config import read_rig
from rig.errors import PortError
from rig.fakes import FakeClock
from rig.replay import ReplayError, replaying
from rig.rig import open_rig
from rig.serial_port import open_serial
from rig.wire_record import read_record, recording
from tests.system.command import litrig


@pytest.fixture
def far_end() -> Iterator[tuple[int, str]]:
    master, slave = os.openpty()
    tty.setraw(slave)
    yield master, os.ttyname(slave)
    os.close(master)
    os.close(slave)


def entry(way: str, content: bytes = b"", t: float = 0.0) -> dict[str, object]:
    return {"port": "/dev/ttyA", "way": way, "bytes": content, "t": t}


def test_bytes_are_recorded_with_time_direction_and_port(tmp_path: Path, far_end: tuple[int, str]) -> None:
    master, port = far_end
    with recording(tmp_path / "w"):
        serial_port = open_serial(port, 115_200)
        serial_port.write(b"?")
        assert os.read(master, 9) == b"?"
        os.write(master, b"<Idle>\n")
        select.select([serial_port.fileno()], [], [])
        assert serial_port.read(99) == b"<Idle>\n"
        os.write(master, b"late")
        select.select([serial_port.fileno()], [], [])
        serial_port.reset_input_buffer()
        serial_port.close()
    header, *lines = [json.loads(line) for line in (tmp_path / "w").read_text().splitlines()]
    assert header["kind"] == "litrig wire record"
    assert [(line["way"], bytes.fromhex(line["bytes"])) for line in lines] == [
        ("open", b""),
        ("out", b"?"),
        ("in", b"<Idle>\n"),
        ("lost", b"late"),
        ("close", b""),
    ]
    assert {line["port"] for line in lines} == {port}
    assert lines[0]["baud"] == 115_200
    times = [line["t"] for line in lines]
    assert times == sorted(times)


def test_nothing_is_recorded_unasked_and_a_second_session_is_appended(tmp_path: Path, far_end: tuple[int, str]) -> None:
    record = tmp_path / "w"
    for content in (b"first", b"second"):
        with recording(record):
            serial_port = open_serial(far_end[1], 9600)
            serial_port.write(content)
            serial_port.close()
        serial_port = open_serial(far_end[1], 9600)
        serial_port.write(b"unheard")
        serial_port.close()
    assert [line["bytes"] for line in read_record(record) if line["way"] == "out"] == [b"first", b"second"]


def test_a_record_that_was_cut_off_is_read_up_to_there(tmp_path: Path, far_end: tuple[int, str]) -> None:
    with recording(tmp_path / "w"):
        open_serial(far_end[1], 9600).close()
    whole = (tmp_path / "w").read_bytes()
    (tmp_path / "w").write_bytes(whole[:-5])
    assert [line["way"] for line in read_record(tmp_path / "w")] == ["open"]


@pytest.mark.parametrize("content", [b"", b"hello\n", b"[]\n", b'{"kind": "litrig wire record"}\n{"port": 1}\n'])
def test_what_is_no_record_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "w").write_bytes(content)
    with pytest.raises(FormatError, match="wire record"):
        read_record(tmp_path / "w")


def test_a_record_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="name another file"), recording(tmp_path / "no" / "w"):
        pass


TALK = [
    entry("open"),
    entry("out", b"a"),
    entry("in", b"A"),
    entry("out", b"b"),
    entry("in", b"B1"),
    entry("in", b"B2"),
]


def test_a_replay_answers_as_the_device_did() -> None:
    with replaying(TALK):
        port = open_serial("/dev/ttyA", 9600)
        assert port.read(9) == b""
        port.write(b"a")
        assert port.read(9) == b"A"
        port.write(b"b")
        assert port.in_waiting == 4
        assert port.read(3) == b"B1B"


def test_bytes_that_nobody_read_then_are_not_read_now() -> None:
    with replaying([entry("open"), entry("out", b"a"), entry("lost", b"late"), entry("out", b"a"), entry("in", b"A")]):
        port = open_serial("/dev/ttyA", 9600)
        port.write(b"a")
        assert (port.read(9), port.in_waiting) == (b"", 4)
        port.reset_input_buffer()
        assert port.in_waiting == 0
        port.write(b"a")
        assert port.read(9) == b"A"


def test_with_a_clock_answers_take_the_time_that_they_took() -> None:
    clock = FakeClock()
    with replaying([entry("open"), entry("out", b"a", 5.0), entry("in", b"A", 5.5), entry("in", b"B", 6.5)], clock):
        port = open_serial("/dev/ttyA", 9600)
        port.write(b"a")
        assert port.read(9) == b""
        clock.sleep(0.6)
        assert port.read(9) == b"A"
        clock.sleep(1.0)
        assert port.read(9) == b"B"


@pytest.mark.parametrize(
    ("written", "message"),
    [
        pytest.param(b"x", "should be 61", id="another byte"),
        pytest.param(b"abc", "none at all, for the record ends here", id="more than then"),
        pytest.param(b"a", "ended before b'b'", id="less than then"),
    ],
)
def test_a_replay_fails_where_the_host_differs(written: bytes, message: str) -> None:
    with pytest.raises(ReplayError, match=message), replaying(TALK):
        open_serial("/dev/ttyA", 9600).write(written)


def test_a_replay_knows_its_ports_and_how_often_they_were_opened() -> None:
    with pytest.raises(ReplayError, match="/dev/ttyA: opened less often"), replaying(TALK):
        pass
    with pytest.raises(PortError, match="/dev/ttyB: the record knows no"), replaying(TALK):
        open_serial("/dev/ttyB", 9600)


def test_a_recorded_move_of_the_command_replays_without_a_device(sphere_sim: RunningSim, tmp_path: Path) -> None:
    record = tmp_path / "wires.jsonl"
    moved = litrig(
        "rig", "move", sphere_sim.rig_toml, "--angle", "37", "--record", record, environment=sphere_sim.environment
    )
    assert moved.returncode == 0, moved.stderr
    config = read_rig(sphere_sim.rig_toml)
    sphere_sim.side_channel.request("shutdown")
    # With their time, for on a busy machine an answer may have come too late.
    with replaying(read_record(record), MonotonicClock()), open_rig(config, use=frozenset({"turntable"})) as rig:
        rig.turntable.home()
        assert f"turntable at {rig.turn_to(37).angle_deg:.2f}°\n" == moved.stdout
    with (
        pytest.raises(ReplayError, match="should be"),
        replaying(read_record(record), MonotonicClock()),
        open_rig(config, use=frozenset({"turntable"})) as rig,
    ):
        rig.turntable.home()
        rig.turn_to(38)


def test_a_recorded_aim_of_the_arm_replays_without_a_device(relief_sim: RunningSim, tmp_path: Path) -> None:
    config = read_rig(relief_sim.rig_toml)
    parts = frozenset({"arm", "lights"})
    with recording(tmp_path / "w"), open_rig(config, use=parts) as rig:
        rig.arm.home()
        aimed = rig.light_from(200, 60)
        rig.lights.switch_on()
    with replaying(read_record(tmp_path / "w")), open_rig(config, use=parts) as rig:
        rig.arm.home()
        assert rig.light_from(200, 60) == aimed
        rig.lights.switch_on()
