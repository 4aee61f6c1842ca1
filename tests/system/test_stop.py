"""Ctrl-C and SIGTERM, as the wires see them."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from firmware_sim.config import SimConfig
from firmware_sim.launch import RunningSim, simulated_rig
from litrig.base.capture_folder.journal import read_journal
from litrig.base.capture_folder.reader import read_capture
from tests.system.command import start

PATIENCE_S = 60.0
STOP_S = 0.5
"""On the simulator's clock, which is this one; a loaded machine may make it longer, and then something is wrong."""


def wait_until(true: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < deadline_s, "waited in vain"
        time.sleep(0.02)  # noqa: TID251  # a process outside is waited for


def moving(sim: RunningSim) -> Callable[[], bool]:
    return lambda: bool(sim.side_channel.status()["turntable_moving"])


def test_sigterm_stops_a_turning_table_where_it_is(sphere_sim: RunningSim) -> None:
    process = start("rig", "move", sphere_sim.rig_toml, "--angle", "700", environment=sphere_sim.environment)
    wait_until(moving(sphere_sim))
    process.send_signal(signal.SIGTERM)
    _, error = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, error
    assert error.strip() == "litrig: interrupted"
    wait_until(lambda: not moving(sphere_sim)())  # braking takes its time
    assert sphere_sim.side_channel.status()["turntable_deg"] < 650


def test_the_stop_is_on_the_wire_within_half_a_second(sphere_sim: RunningSim) -> None:
    process = start("rig", "move", sphere_sim.rig_toml, "--angle", "700", environment=sphere_sim.environment)
    wait_until(moving(sphere_sim))
    asked_s = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE_S)
    recent = sphere_sim.side_channel.status()["wires"]["turntable"]["recent"]
    stops_s = [time_s for time_s, way, content in recent if is_goal(way, content) and time_s > asked_s]
    assert stops_s[0] < asked_s + STOP_S


def test_a_killed_command_leaves_a_table_that_stops_by_itself_and_holds(sphere_sim: RunningSim) -> None:
    process = start("rig", "move", sphere_sim.rig_toml, "--angle", "700", environment=sphere_sim.environment)
    wait_until(moving(sphere_sim))
    process.kill()
    process.communicate(timeout=PATIENCE_S)
    wait_until(lambda: not moving(sphere_sim)())
    assert sphere_sim.side_channel.status()["turntable_deg"] < 650


def test_a_power_sag_in_a_move_says_that_the_position_is_lost(sphere_sim: RunningSim) -> None:
    process = start("rig", "move", sphere_sim.rig_toml, "--angle", "700", environment=sphere_sim.environment)
    wait_until(moving(sphere_sim))
    sphere_sim.side_channel.request("turntable.brown_out")
    _, error = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1, error
    assert "its position is lost; check the supply, then home it" in error
    assert "Traceback" not in error


def test_an_impatient_operator_does_not_cut_the_stop_short(sphere_sim: RunningSim) -> None:
    process = start("rig", "move", sphere_sim.rig_toml, "--angle", "700", environment=sphere_sim.environment)
    wait_until(moving(sphere_sim))
    for _ in range(6):
        process.send_signal(signal.SIGINT)
        time.sleep(0.01)  # noqa: TID251  # a person's fingers
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    wait_until(lambda: not moving(sphere_sim)())
    assert sphere_sim.side_channel.status()["turntable_deg"] < 650


def test_a_stop_ends_homing(relief_sim: RunningSim) -> None:
    process = start("rig", "home", relief_sim.rig_toml, environment=relief_sim.environment)
    wait_until(lambda: relief_sim.side_channel.status()["arm_state"] == "Home")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert relief_sim.side_channel.status()["arm_state"] == "Alarm", "the position is unknown, and the controller knows"


def test_an_interrupt_and_another_one_stop_a_session(sphere_sim: RunningSim, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", folder, "--slices", "64")
    process = start(*command, environment=sphere_sim.environment)
    wait_until(lambda: len(list((folder / "data/frames").glob("*.jpg"))) >= 1)
    sphere_sim.side_channel.request("camera.hang")
    time.sleep(0.5)  # noqa: TID251  # into the exposure that never ends
    for _ in range(2):
        process.send_signal(signal.SIGINT)
        time.sleep(0.1)  # noqa: TID251  # a person's fingers
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert read_journal(folder / "data/journal.jsonl")[-1]["ev"] == "stop"


def test_a_rig_that_vanishes_in_a_session_is_on_hold_and_keeps_the_frames(tmp_path: Path) -> None:
    folder = tmp_path / "s"
    with simulated_rig(SimConfig()) as sim:
        command = ("capture", "amc", sim.rig_toml, "-o", folder, "--slices", "64")
        process = start(*command, environment=sim.environment)
        wait_until(lambda: len(list((folder / "data/frames").glob("*.jpg"))) >= 2)
    _, error = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 3, error
    assert "Traceback" not in error
    assert "on hold; the frames so far are safe" in error
    assert len(read_capture(folder).frames) >= 2


def test_one_interrupt_pauses_a_session_and_keeps_its_frames(sphere_sim: RunningSim, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", folder, "--slices", "64")
    process = start(*command, environment=sphere_sim.environment)
    wait_until(lambda: len(list((folder / "data/frames").glob("*.jpg"))) >= 2)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert "they are safe in" in error
    assert f"litrig capture resume {folder} goes on" in error
    assert 2 <= len(read_capture(folder).frames) < 64


def test_a_stop_gets_through_while_the_camera_hangs(sphere_sim: RunningSim, tmp_path: Path) -> None:
    folder = tmp_path / "s"
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", folder, "--slices", "64")
    process = start(*command, environment=sphere_sim.environment)
    wait_until(lambda: len(list((folder / "data/frames").glob("*.jpg"))) >= 1)
    sphere_sim.side_channel.request("camera.hang")
    time.sleep(0.5)  # noqa: TID251  # into the exposure that never ends
    process.send_signal(signal.SIGTERM)
    asked_s = time.monotonic()
    process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    recent = sphere_sim.side_channel.status()["wires"]["turntable"]["recent"]
    writes = [time_s for time_s, way, content in recent if is_goal(way, content)]
    assert max(writes) > asked_s, "no goal was written after the signal"


def is_goal(way: str, content: str) -> bool:
    """Tell whether bytes to the servo write its goal position: instruction 3, address 116."""
    return way == "in" and content[14:20] == "037400"


def test_the_camera_process_does_not_outlive_a_killed_command(sphere_sim: RunningSim, tmp_path: Path) -> None:
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", tmp_path / "s", "--slices", "64")
    process = start(*command, environment=sphere_sim.environment)
    wait_until(lambda: bool(workers_of(process.pid)))
    (worker,) = workers_of(process.pid)
    sphere_sim.side_channel.request("camera.hang")
    process.kill()
    process.communicate(timeout=PATIENCE_S)
    wait_until(lambda: not is_alive(worker))


def workers_of(parent: int) -> list[int]:
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            if int(fields[1]) == parent and b"rig.camera.worker" in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except (OSError, IndexError):
            continue
    return found


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False
