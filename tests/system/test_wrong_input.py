"""Wrong input to each command: one line that names it, the right exit status, and nothing left behind."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import serial

from firmware_sim.launch import RunningSim
from litrig.base.capture_folder import layout
from rig.config import read_rig
from tests.system.command import error_line, litrig

EXAMPLES = Path(__file__).parents[2] / "examples"
BRUSHED, RELIEF = EXAMPLES / "captures" / "brushed", EXAMPLES / "captures" / "relief"


def toml(text: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        (folder / "given.toml").write_text(text)
        return folder / "given.toml"

    return write


def file(name: str, content: bytes) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        (folder / name).write_bytes(content)
        return folder / name

    return write


def missing(name: str) -> Callable[[Path], Path]:
    return lambda folder: folder / name


def truncated_frame(sample: Path) -> Callable[[Path], Path]:
    """Copy the pictures of a sample into a plain folder, with one cut short."""

    def write(folder: Path) -> Path:
        plain = folder / "plain"
        shutil.copytree(sample / layout.FRAMES, plain)
        frames = sorted(plain.iterdir())
        frames[3].write_bytes(frames[3].read_bytes()[:-2000])
        if sample == RELIEF:
            shutil.copy(sample / "data" / "relief.lp", plain)
        else:
            lines = [f"{frame.name},{15 * index}" for index, frame in enumerate(frames)]
            (plain / "angles.csv").write_text("\n".join(lines))
        return plain

    return write


def damaged_session(sample: Path) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        shutil.copytree(sample, folder / "session")
        frame = sorted((folder / "session" / layout.FRAMES).iterdir())[2]
        frame.write_bytes(frame.read_bytes()[:-1000])
        return folder / "session"

    return write


NO_CAMERA = toml("[camera]\ndevice = '/dev/video97'\n[turntable]\nport = '/dev/ttyNOWHERE'")
UNKNOWN_KEY = toml("[turntabel]\nport = 'x'")

CASES = [
    pytest.param(["sim", "run", missing("no.toml"), "--", "true"], "no such file", id="sim run, no SIM.toml"),
    pytest.param(
        ["sim", "run", toml("[scen]\nkind = 'relief'"), "--", "true"], "unknown key 'scen'", id="sim run, unknown key"
    ),
    pytest.param(["rig", "home", missing("no.toml")], "no such file", id="rig home, no RIG.toml"),
    pytest.param(["rig", "home", UNKNOWN_KEY], "unknown key 'turntabel'", id="rig home, unknown key"),
    pytest.param(["rig", "park", NO_CAMERA], "ttyNOWHERE: no such port", id="rig park, no port"),
    pytest.param(["rig", "move", NO_CAMERA, "--angle", "1"], "ttyNOWHERE: no such port", id="rig move, no port"),
    pytest.param(
        ["rig", "light", NO_CAMERA, "--azimuth", "0", "--elevation", "45"], "no lights", id="rig light, no lights"
    ),
    pytest.param(
        ["rig", "snap", NO_CAMERA, "-o", missing("a.png")], "video97: cannot be opened", id="rig snap, no camera"
    ),
    pytest.param(
        ["capture", "amc", NO_CAMERA, "-o", missing("s"), "--slices", "8"],
        "NOWHERE: no such port",
        id="capture amc, no port",
    ),
    pytest.param(
        ["capture", "amc", NO_CAMERA, "-o", missing("s"), "--slices", "2"],
        "slices: 2 is outside",
        id="capture amc, two slices",
    ),
    pytest.param(
        ["capture", "ptm", UNKNOWN_KEY, "-o", missing("s"), "--lights", "8"],
        "unknown key",
        id="capture ptm, unknown key",
    ),
    pytest.param(
        ["capture", "ptm", NO_CAMERA, "-o", missing("s"), "--lights", "8", "--object", "a/b"],
        "object id 'a/b'",
        id="capture ptm, bad id",
    ),
    pytest.param(["capture", "verify", missing("s")], "not a capture folder", id="capture verify, no folder"),
    pytest.param(
        ["amc", "build", missing("s"), "-o", missing("a.amc.ktx2")], "no such folder", id="amc build, no folder"
    ),
    pytest.param(
        ["amc", "build", truncated_frame(BRUSHED), "-o", missing("a.amc.ktx2")],
        r"000003.*jpg: damaged JPEG",
        id="amc build, truncated frame",
    ),
    pytest.param(
        ["amc", "build", damaged_session(BRUSHED), "-o", missing("a.amc.ktx2")],
        r"000002.*jpg: changed since",
        id="amc build, damaged session",
    ),
    pytest.param(
        ["amc", "build", BRUSHED, "-o", missing("no/a.amc.ktx2"), "--size", "16"],
        "does not exist",
        id="amc build, no target folder",
    ),
    pytest.param(["amc", "info", missing("a.amc.ktx2")], "no such file", id="amc info, no file"),
    pytest.param(
        ["amc", "info", file("a.amc.ktx2", b"\xabKTX 20\xbb\r\n\x1a\n")], "a.amc.ktx2", id="amc info, truncated file"
    ),
    pytest.param(["ptm", "fit", missing("s"), "-o", missing("a.ptm")], "no such folder", id="ptm fit, no folder"),
    pytest.param(
        ["ptm", "fit", truncated_frame(RELIEF), "-o", missing("a.ptm")],
        r"000003.*jpg: damaged JPEG",
        id="ptm fit, truncated frame",
    ),
    pytest.param(["ptm", "fit", BRUSHED, "-o", missing("a.ptm")], "light", id="ptm fit, no lights"),
    pytest.param(["ptm", "info", missing("a.ptm")], "(?i)no such file", id="ptm info, no file"),
    pytest.param(
        ["ptm", "relight", file("a.ptm", b"PTM_1.2\nPTM_FORMAT_LRGB\n"), "--light", "0", "0", "-o", missing("a.png")],
        "a.ptm",
        id="ptm relight, truncated file",
    ),
    pytest.param(["render", missing("a.amc.ktx2"), "-o", missing("a.png")], "no such file", id="render, no file"),
    pytest.param(["render", file("a.txt", b"x"), "-o", missing("a.png")], "a.txt", id="render, unknown kind"),
    pytest.param(
        ["matcap", "split", missing("a.png"), "-o", missing("l.png"), missing("h.png")],
        "a.png: no such file",
        id="matcap split, no file",
    ),
    pytest.param(["matcap", "estimate", file("a.png", b"x")], "a.png: PNG cut short", id="matcap estimate, damaged"),
    pytest.param(
        ["matcap", "decompose", file("a.exr", b"x"), "-o", missing("a.matcap.exr")],
        "a.exr: damaged EXR",
        id="matcap decompose, damaged",
    ),
    pytest.param(["matcap", "info", missing("a.matcap.exr")], "no such file", id="matcap info, no file"),
    pytest.param(
        ["matcap", "edit", file("a.matcap.exr", b"x" * 99), "-o", missing("a.png")],
        "a.matcap.exr: no EXR",
        id="matcap edit, damaged",
    ),
    pytest.param(
        ["matcap", "edit", missing("a.matcap.exr"), "-o", missing("a.png"), "--recipe", toml("[[steps]]\nop = 'x'")],
        "given.toml: steps.0: Input tag 'x'",
        id="matcap edit, unknown step",
    ),
    pytest.param(
        ["matcap", "export", missing("a.matcap.exr"), "-o", missing("b.exr")],
        "no such file",
        id="matcap export, no file",
    ),
    pytest.param(["rig", "home", "/dev/zero"], "/dev/zero: is a device or a pipe", id="rig home, no end"),
    pytest.param(["ptm", "fit", RELIEF, "-o", missing("a.ptm"), "--lp", "/dev/zero"], "is a device", id="lp, no end"),
    pytest.param(
        ["amc", "build", BRUSHED, "-o", missing(f"{'y' * 300}.amc.ktx2")], "File name too long", id="-o, too long"
    ),
    pytest.param(["demo", "--out", missing("y" * 300)], "File name too long", id="demo, name too long"),
    pytest.param(["demo", "--out", file("mine", b"x")], "mine: is a file", id="demo, a file"),
    pytest.param(
        ["amc", "build", BRUSHED, "-o", missing("a.amc.ktx2"), "--circle", "160", "120", "0.01"],
        "radius 0.01 px",
        id="amc build, a circle too small",
    ),
    pytest.param(
        ["amc", "build", BRUSHED, "-o", missing("a.amc.ktx2"), "--distance", "1e300"], "1e.300 radii", id="far camera"
    ),
]


@pytest.mark.parametrize(("command", "message"), CASES)
def test_wrong_input_is_one_line_and_leaves_nothing(
    tmp_path: Path, command: list[str | Path | Callable[[Path], Path]], message: str
) -> None:
    words = [word(tmp_path) if callable(word) else word for word in command]
    before = sorted(tmp_path.rglob("*"))
    result = litrig(*words)
    assert result.returncode == 1, result.stderr
    assert re.search(message, error_line(result)), result.stderr
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(["rig", "move", "rig.toml"], id="missing option"),
        pytest.param(["rig", "move", "rig.toml", "--angle", "east"], id="not a number"),
        pytest.param(["captur"], id="unknown command"),
        pytest.param(["ptm", "fit", "x", "-o", "y.ptm", "--colour", "cmyk"], id="unknown choice"),
    ],
)
def test_wrong_usage_is_status_two(command: list[str]) -> None:
    result = litrig(*command)
    assert result.returncode == 2
    assert "Error" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_port_that_is_taken_is_one_line(sphere_sim: RunningSim) -> None:
    config = read_rig(sphere_sim.rig_toml)
    assert config.turntable is not None
    with serial.Serial(config.turntable.port, exclusive=True):
        result = litrig("rig", "move", sphere_sim.rig_toml, "--angle", "5", environment=sphere_sim.environment)
    assert result.returncode == 1
    assert "held by another program" in error_line(result)


def test_an_angle_out_of_range_moves_nothing(sphere_sim: RunningSim) -> None:
    before = sphere_sim.side_channel.status()["turntable_deg"]
    result = litrig("rig", "move", sphere_sim.rig_toml, "--angle", "9999", environment=sphere_sim.environment)
    assert result.returncode == 1
    assert "outside -360..720°; nothing moved" in error_line(result)
    assert sphere_sim.side_channel.status()["turntable_deg"] == pytest.approx(before, abs=0.1)  # torque may come on


def test_a_folder_that_is_not_empty_stays_as_it_is(sphere_sim: RunningSim, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", tmp_path, "--slices", "8")
    result = litrig(*command, environment=sphere_sim.environment)
    assert result.returncode == 1
    assert "not empty" in error_line(result)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_rig_that_stalls_in_a_session_is_on_hold(sphere_sim: RunningSim, tmp_path: Path) -> None:
    sphere_sim.side_channel.request("turntable.stall")
    command = ("capture", "amc", sphere_sim.rig_toml, "-o", tmp_path / "s", "--slices", "8")
    result = litrig(*command, environment=sphere_sim.environment)
    assert result.returncode == 3
    assert "on hold" in result.stderr
    assert "what blocks it" in result.stderr


def test_the_status_of_a_simulated_command_comes_through() -> None:
    assert litrig("sim", "run", EXAMPLES / "sim-amc.toml", "--", "sh", "-c", "exit 7").returncode == 7
