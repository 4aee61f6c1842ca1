"""Adapters that are pulled out and plugged in again, and mishaps that SIM.toml brings."""

import errno
import os
import time
from pathlib import Path

import pytest
import serial

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from firmware_sim.wire import Wire
from tests.firmware_sim.ports import arm_of, port_of, turntable_of

PATIENCE_S = 10.0


class Parrot:
    """Says what it hears, and counts how often it was asked."""

    baud = 115_200
    asked = 0

    def feed(self, content: bytes) -> bytes:
        self.asked += 1
        return content

    def due_s(self) -> float | None:
        return None


def test_a_port_comes_back_under_another_name_and_its_link_leads_there(tmp_path: Path) -> None:
    link = tmp_path / "by-id" / "parrot"
    wire = Wire(Parrot(), time.monotonic, link)
    first = wire.path
    assert link.readlink() == Path(first)
    wire.unplug()
    assert not link.is_symlink()
    second = wire.replug()
    assert second != first
    assert link.readlink() == Path(second)
    with serial.Serial(str(link), 115_200, timeout=5) as port:
        port.write(b"hello")
        while not port.in_waiting:
            wire.service()
        assert port.read(5) == b"hello"
    wire.close()


def test_who_has_the_port_open_notices(tmp_path: Path) -> None:
    wire = Wire(Parrot(), time.monotonic)
    with serial.Serial(wire.path, 115_200) as port:
        wire.unplug()
        with pytest.raises(OSError, match=os.strerror(errno.EIO)):
            _ = port.in_waiting


def test_time_passes_for_a_device_that_is_unplugged() -> None:
    parrot = Parrot()
    wire = Wire(parrot, time.monotonic)
    wire.unplug()
    wire.unplug()
    wire.service()
    assert parrot.asked == 1
    assert wire.master is None


def test_both_ports_can_be_pulled_out(sphere: RunningSim) -> None:
    for name in ("turntable", "arm"):
        before = port_of(sphere, name)
        sphere.side_channel.request(f"{name}.unplug")
        assert not (sphere.rig_toml.parent / "by-id" / name).is_symlink()
        after = sphere.side_channel.request(f"{name}.replug")["port"]
        assert after == port_of(sphere, name) != before
        assert (sphere.rig_toml.parent / "by-id" / name).readlink() == Path(after)
    with turntable_of(sphere) as table:
        assert table.packets.ping(table.port, 1)[0] == 1060
    with arm_of(sphere) as arm:
        arm.port.write(b"?")
        assert arm.port.readline().startswith(b"<")


def test_mishaps_of_the_file_are_there_from_the_start() -> None:
    faults = {
        "model_number": 1020,
        "firmware": 37,
        "alert_bits": 1,
        "slip_deg": 12.0,
        "brown_out_at_s": 0.0,
        "unplug_at_s": 0.2,
        "replug_at_s": 0.4,
    }
    config = SimConfig.model_validate({"turntable": {"start_deg": 30.0, "others": [9], "faults": faults}})
    with simulated_rig(config) as sim:
        first = sim.rig_toml.read_text("utf-8").split('port = "')[1].split('"')[0]
        deadline_s = time.monotonic() + PATIENCE_S
        while (port := port_of(sim, "turntable")) == first or not port:
            assert time.monotonic() < deadline_s
        assert sim.side_channel.status()["turntable_deg"] == pytest.approx(42)
        with turntable_of(sim) as table:
            found, _ = table.packets.broadcastPing(table.port)
            assert found == {1: [1020, 37], 9: [1060, 45]}
