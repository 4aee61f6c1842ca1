import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from firmware_sim.config import SimConfig
from firmware_sim.errors import SideChannelError, SimError, SimServerError
from firmware_sim.launch import RunningSim, simulated_rig
from firmware_sim.side_channel import SideChannel
from tests.firmware_sim.conftest import ROOT, Client
from tests.firmware_sim.ports import arm_of

RUN = "from firmware_sim.cli import sim; sim(prog_name='sim')"
EXAMPLE = str(ROOT / "examples" / "sim-amc.toml")


def sim_run(*command: str) -> list[str]:
    return [sys.executable, "-c", RUN, "run", EXAMPLE, "--", *command]


def environment() -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(ROOT)}


def eventually(condition: Callable[[], bool]) -> bool:
    deadline_s = time.monotonic() + 10
    while not condition():
        if time.monotonic() > deadline_s:
            return False
    return True


def processes_in(folder: Path) -> list[int]:
    """Return the processes that have the folder in their command line."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if str(folder).encode() in path.read_bytes():
                found.append(int(path.parent.name))
        except OSError:  # it has just ended
            continue
    return found


def studios_in(folder: Path) -> list[int]:
    return [pid for pid in processes_in(folder) if b"studio" in Path(f"/proc/{pid}/cmdline").read_bytes()]


def test_the_end_of_the_body_ends_everything(tmp_path: Path) -> None:
    with simulated_rig(SimConfig(), tmp_path) as sim:
        # A process that is just about to become the studio has no command line for a moment.
        assert eventually(lambda: len(processes_in(tmp_path)) == 2)
        assert sim.rig_toml == tmp_path / "RIG.toml"
        port = Path(sim.side_channel.status()["wires"]["turntable"]["port"])
        assert port.exists()
    assert processes_in(tmp_path) == []
    assert sorted(path.name for path in tmp_path.iterdir()) == ["RIG.toml", "server.log", "sim.json"]
    assert (tmp_path / "server.log").read_text() == ""


def test_status_says_where_everything_is(sphere: RunningSim) -> None:
    status = sphere.side_channel.status()
    assert status["camera"].keys() == {"streaming", "delivered", "dropped", "number"}
    assert status["wires"].keys() == {"turntable", "arm"}
    assert status["time_s"] == pytest.approx(time.monotonic(), abs=1)


def test_a_simulator_that_cannot_start_says_why(tmp_path: Path) -> None:
    (tmp_path / "frames.bin").touch()
    with (
        pytest.raises(SimServerError, match=r"did not start .*FileExistsError.*frames\.bin"),
        simulated_rig(SimConfig(), tmp_path),
    ):
        pass
    assert processes_in(tmp_path) == []


def test_a_dead_simulator_is_reported(tmp_path: Path) -> None:
    with simulated_rig(SimConfig(), tmp_path) as sim:
        sim.side_channel.shutdown()
        assert eventually(lambda: processes_in(tmp_path) == [])
        with pytest.raises(SideChannelError, match="is it running"):
            sim.side_channel.status()


def test_the_simulator_does_not_outlive_a_killed_parent(tmp_path: Path) -> None:
    code = f"""
import sys
from pathlib import Path
from firmware_sim.config import SimConfig
from firmware_sim.launch import simulated_rig
with simulated_rig(SimConfig(), Path({str(tmp_path)!r})):
    print("up", flush=True)
    sys.stdin.read()
"""
    command = [sys.executable, "-c", code]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=environment(), stdin=pipe, stdout=pipe) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"up\n"
        assert eventually(lambda: len(processes_in(tmp_path)) >= 2)
        parent.kill()
    assert eventually(lambda: processes_in(tmp_path) == [])
    assert not (tmp_path / "frames.bin").exists()


def test_a_lost_camera_process_ends_the_simulator(tmp_path: Path) -> None:
    with simulated_rig(SimConfig(), tmp_path):
        assert eventually(lambda: len(studios_in(tmp_path)) == 1)
        os.kill(studios_in(tmp_path)[0], signal.SIGKILL)
        assert eventually(lambda: processes_in(tmp_path) == [])
        assert "camera's process ended by itself with status -9" in (tmp_path / "server.log").read_text()


def test_nobody_on_the_side_channel_is_an_error(tmp_path: Path) -> None:
    with SideChannel(tmp_path / "nothing.sock") as channel, pytest.raises(SimError, match=r"nothing\.sock"):
        channel.status()


def test_the_arm_s_lamp_lights_the_relief(relief_rig: RunningSim) -> None:
    client = Client(relief_rig)
    code = """
camera = opened()
for line in sys.stdin:
    picture = fresh(camera).astype(int)
    say(mean=float(picture.mean()), tilt=float(picture[180:300, 240:400, :].mean() - picture[:40].mean()))
"""
    with arm_of(relief_rig) as arm, client.talk(code) as talk:
        arm.home()
        assert arm.ask("G0 X-180 Y-40")[-1] == "ok"
        means = []
        for line in ("M5", "M3 S1000", "S300", "M5"):
            assert arm.ask(line)[-1] == "ok"
            assert arm.ask("G4 P0")[-1] == "ok"
            talk.tell()
            means.append(talk.hear()["mean"])
    dark, full, dim, dark_again = means
    assert full > 1.5 * dim > 20
    assert dark == pytest.approx(dark_again, abs=1)
    assert dark < 4


@pytest.mark.parametrize(
    ("command", "status"),
    [
        pytest.param(["sh", "-c", 'test -f "$LITRIG_RIG"'], 0, id="RIG.toml is there while it runs"),
        pytest.param(["sh", "-c", "exit 7"], 7, id="the status is handed on"),
        pytest.param(["sh", "-c", "kill -TERM $$"], 128 + signal.SIGTERM, id="so is the signal that ended it"),
    ],
)
def test_sim_run_hands_on_the_exit_status(command: list[str], status: int) -> None:
    assert subprocess.run(sim_run(*command), env=environment(), check=False).returncode == status


def test_sim_run_hands_over_input_and_output() -> None:
    process = subprocess.run(
        sim_run("tr", "a-z", "A-Z"), env=environment(), input="litrig\n", capture_output=True, text=True, check=True
    )
    assert (process.stdout, process.stderr) == ("LITRIG\n", "")


def test_sim_run_without_such_a_command_says_so() -> None:
    process = subprocess.run(sim_run("no-such-command"), env=environment(), capture_output=True, text=True, check=False)
    assert process.returncode == 1
    assert "no-such-command: cannot be run (No such file or directory)" in process.stderr


TRAP = "trap 'echo caught; exit 5' INT; echo ready; while :; do sleep 0.02; done"


def test_an_interrupt_of_sim_run_reaches_the_command_once() -> None:
    pipe = subprocess.PIPE
    with subprocess.Popen(sim_run("sh", "-c", TRAP), env=environment(), stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        assert process.stdout.read() == "caught\n"
        assert process.wait(10) == 5


def test_ctrl_c_on_a_terminal_reaches_the_command_once() -> None:
    leader, follower = os.openpty()
    try:
        with subprocess.Popen(
            [sys.executable, "-c", TAKE_TERMINAL, *sim_run("sh", "-c", TRAP)],
            env=environment(),
            stdin=follower,
            stdout=follower,
            start_new_session=True,
        ) as process:
            heard = b""
            while b"ready" not in heard:
                heard += os.read(leader, 1000)
            os.write(leader, b"\x03")
            while heard.count(b"caught") == 0:
                heard += os.read(leader, 1000)
            assert process.wait(10) == 5
            assert heard.count(b"caught") == 1
    finally:
        os.close(leader)
        os.close(follower)


TAKE_TERMINAL = """
import fcntl, os, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.argv[1], sys.argv[1:])
"""


def test_devices_outlive_a_client_that_is_killed() -> None:
    script = """
python3 -c 'import os, signal, time; f = os.open("/dev/video42", os.O_RDWR); os.kill(os.getpid(), signal.SIGKILL)'
python3 -c 'import os; f = os.open("/dev/video42", os.O_RDWR); print("opened again")'
"""
    process = subprocess.run(
        sim_run("sh", "-c", script), env=environment(), capture_output=True, text=True, check=True, timeout=30
    )
    assert process.stdout == "opened again\n"
