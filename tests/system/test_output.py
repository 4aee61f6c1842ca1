"""Where output goes, when it cannot go there, and when the command is stopped before it has begun."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.system.command import LITRIG

BRUSHED = Path(__file__).parents[2] / "examples" / "captures" / "brushed"


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(["--help"], id="help of all"),
        pytest.param(["--version"], id="a few bytes"),
        pytest.param(["capture", "verify", str(BRUSHED)], id="an answer"),
    ],
)
def test_output_to_a_full_disk_is_one_line_and_a_failure(words: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        result = subprocess.run([*LITRIG, *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert result.returncode == 1
    assert result.stderr.startswith("litrig: standard output: cannot be written (No space left on device); ")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(["--help"], id="help of all"),
        pytest.param(["amc", "build", "--help"], id="help of one"),
        pytest.param(["capture", "verify", str(BRUSHED)], id="an answer"),
    ],
)
def test_a_reader_who_has_had_enough_makes_no_failure(words: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    result = subprocess.run([*LITRIG, *words], stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert (result.returncode, result.stderr) == (0, "")


def test_an_error_that_nobody_can_read_keeps_its_status(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        result = subprocess.run([*LITRIG, "capture", "verify", str(tmp_path)], stderr=full, check=False)
    assert result.returncode == 1


INTERRUPTED_WHILE_LOADING = """
import sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "processing.amc.cli":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupting())
from litrig.cli import main
assert not {"click", "numpy", "pydantic"} & set(sys.modules), "the front door opens at once"
main()
"""


def test_an_interrupt_while_the_command_loads_is_one_line() -> None:
    words = [sys.executable, "-c", INTERRUPTED_WHILE_LOADING]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stderr) == (130, "litrig: interrupted\n")


def test_a_link_to_an_earlier_demo_is_not_followed(tmp_path: Path) -> None:
    earlier = tmp_path / "earlier"
    earlier.mkdir()
    (earlier / ".litrig-demo").touch()
    (tmp_path / "link").symlink_to(earlier)
    result = subprocess.run(
        [*LITRIG, "demo", "--out", str(tmp_path / "link")], capture_output=True, text=True, check=False
    )
    assert result.returncode == 1
    assert "is a link to an earlier demo; name that folder itself" in result.stderr
    assert (earlier / ".litrig-demo").is_file()
