"""`litrig rig doctor` and `litrig rig init` on the simulated rig, as a user runs them."""

import json
import zipfile
from pathlib import Path

from firmware_sim.launch import RunningSim
from rig.config import CameraConfig, TurntableConfig, read_rig
from rig.wire_record import read_record
from tests.system.command import error_line, litrig


def test_a_rig_that_was_found_is_healthy_and_the_bundle_has_its_wires(sphere_sim: RunningSim, tmp_path: Path) -> None:
    given = read_rig(sphere_sim.rig_toml)
    assert isinstance(given.turntable, TurntableConfig)
    assert given.arm is not None
    assert isinstance(given.camera, CameraConfig)
    paths = ("--port", given.turntable.port, "--port", given.arm.port, "--camera", given.camera.device)
    command = ("rig", "init", "-o", tmp_path / "rig.toml", *paths)
    made = litrig(*command, environment=sphere_sim.environment)
    assert made.returncode == 0, made.stderr
    found = read_rig(tmp_path / "rig.toml")
    assert isinstance(found.turntable, TurntableConfig)
    assert (found.turntable.port, found.turntable.id) == (given.turntable.port, given.turntable.id)
    assert found.arm == given.arm
    assert "servo 1 at 57600 baud" in made.stdout

    again = litrig(*command, environment=sphere_sim.environment)
    assert again.returncode == 1
    assert "rig.toml: is there already" in error_line(again)

    bundle, record = tmp_path / "b.zip", tmp_path / "w.jsonl"
    doctor = ("rig", "doctor", tmp_path / "rig.toml", "--json", "--bundle", bundle, "--record", record)
    examined = litrig(*doctor, environment=sphere_sim.environment)
    report = json.loads(examined.stdout)
    assert report["healthy"], report
    assert examined.returncode == 0
    assert {finding["part"] for finding in report["findings"]} == {
        "turntable",
        "arm",
        "lights",
        "camera",
        "disk",
        "clock",
    }
    with zipfile.ZipFile(bundle) as archive:
        packed = json.loads(archive.read("doctor.json"))
        wires = archive.read("wires.jsonl")
    assert packed["findings"] == report["findings"]
    recorded = {entry["port"] for entry in read_record(record)}
    assert recorded == {given.turntable.port, given.arm.port}
    assert all(port.encode() in wires for port in recorded)
    assert sphere_sim.side_channel.status()["turntable_moving"] is False


def test_faults_are_told_with_next_steps_and_nothing_moves(sphere_sim: RunningSim) -> None:
    sphere_sim.side_channel.request("turntable.hardware_error", bits=0b100000)
    sphere_sim.side_channel.request("camera.unplug")
    before = sphere_sim.side_channel.status()["turntable_deg"]
    examined = litrig("rig", "doctor", sphere_sim.rig_toml, "--move", environment=sphere_sim.environment)
    assert examined.returncode == 1
    assert "FAULT    turntable: hardware error: servo 1: overload" in examined.stdout
    assert "→ remove the cause, then switch the servo's power off and on" in examined.stdout
    assert "FAULT    camera: picture" in examined.stdout
    assert "not healthy: 2 faults" in examined.stdout
    assert "Nothing was moved" in examined.stderr
    assert sphere_sim.side_channel.status()["turntable_deg"] == before


def test_with_move_the_table_travels_and_rests(sphere_sim: RunningSim, tmp_path: Path) -> None:
    lines = sphere_sim.rig_toml.read_text().splitlines()
    table = lines[lines.index("[turntable]") : lines.index("[arm]")]
    (tmp_path / "rig.toml").write_text("\n".join([*table, "min_deg = 0.0", "max_deg = 40.0"]))
    examined = litrig("rig", "doctor", tmp_path / "rig.toml", "--move", environment=sphere_sim.environment)
    assert examined.returncode == 0, examined.stdout
    assert "ok       turntable: travel: went to 0° and 40°" in examined.stdout
    assert abs(sphere_sim.side_channel.status()["turntable_deg"]) < 0.5


def test_a_wires_file_without_a_bundle_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text("")
    result = litrig("rig", "doctor", tmp_path / "rig.toml", "--wires", tmp_path / "w")
    assert result.returncode == 1
    assert "name one with --bundle" in error_line(result)
