"""The command as a user runs it: a process of its own."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

LITRIG = (sys.executable, "-m", "litrig")


def litrig(*arguments: str | Path, environment: Mapping[str, str] | None = None) -> "subprocess.CompletedProcess[str]":
    """Run `litrig` to its end and return what it said."""
    return subprocess.run(
        [*LITRIG, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
        env=_environment(environment or {}),
    )


def start(*arguments: str | Path, environment: Mapping[str, str]) -> "subprocess.Popen[str]":
    """Start `litrig` in a process group of its own."""
    return subprocess.Popen(
        [*LITRIG, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=_environment(environment),
        start_new_session=True,
    )


def error_line(result: "subprocess.CompletedProcess[str]") -> str:
    """Return the one line of the error, which comes last; fail if there is a traceback or a second one."""
    lines = result.stderr.strip().splitlines()
    assert "Traceback" not in result.stderr, result.stderr
    assert [line.startswith("litrig: ") for line in lines].index(True) == len(lines) - 1, result.stderr
    return lines[-1]


def _environment(additions: Mapping[str, str]) -> dict[str, str]:
    """Add to this process's environment, and let a shell find `litrig` where this Python lies."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    return {**os.environ, "PATH": path, **additions}
