"""What `litrig view` says when there can be no window: one line, status 1, and nothing left of it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from litrig.base.errors import MissingToolError
from processing.amc.files.ktx2 import write_amc
from tests.viewer.analytic import brushed_amc
from tests.viewer.window.desktop import PATIENCE_S, desktop, needs_desktop
from viewer.cli import view

NO_DISPLAY = ":65432"
SCRIPT = """
import os, sys
from pathlib import Path
from litrig.base.errors import LitrigError
from viewer.window.run import view_file
for number in range(1, len(sys.argv), 3):
    os.environ["DISPLAY"], file, mesh = sys.argv[number : number + 3]
    try:
        view_file(Path(file), mesh or None, (200, 150), Path())
    except LitrigError as error:
        print(f"{type(error).__name__}: {error}", flush=True)
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    write_amc(tmp_path / "brushed.amc.ktx2", brushed_amc(16, 8))
    return tmp_path / "brushed.amc.ktx2"


def refusals(*attempts: tuple[str, Path, str], **environment: str) -> list[str]:
    """Try to open windows, each on a display, of a file and on a mesh, in a process apart; each shall say one line.

    A window that failed leaves its library in a state that no later one in the same process should inherit from.
    """
    words = [str(word) for attempt in attempts for word in attempt]
    paths = os.pathsep.join(filter(None, sys.path))
    ran = subprocess.run(
        [sys.executable, "-c", SCRIPT, *words],
        env={**os.environ, "PYTHONPATH": paths, **environment},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    # The library remarks on it when a process tries again after a failure, which the command never does.
    lines = [line for line in ran.stdout.splitlines() if not line.startswith("HelloImGui: calling TearDown()")]
    assert len(lines) == len(attempts)
    return lines


def test_without_a_display_the_other_command_is_named(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(MissingToolError, match=r"no display.*litrig render"):
        CliRunner().invoke(view, [str(file)], standalone_mode=False, catch_exceptions=False)


def test_without_imgui_bundle_it_is_said_how_to_install_it(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "imgui_bundle", None)
    with pytest.raises(MissingToolError, match="pip install imgui-bundle"):
        CliRunner().invoke(view, [str(file)], standalone_mode=False, catch_exceptions=False)


@needs_desktop
def test_a_display_that_does_not_answer_or_has_no_opengl_is_told_apart(file: Path, tmp_path: Path) -> None:
    with desktop(tmp_path, "-extension", "GLX") as bare:
        silent, poor = refusals((NO_DISPLAY, file, ""), (bare.display, file, ""))
    assert silent.startswith("MissingToolError: window: the display cannot be opened") and NO_DISPLAY in silent
    assert poor.startswith("MissingToolError: window: there is no OpenGL 3.3") and "GLX" in poor
    assert "apt-get install" in poor and "litrig render" in poor


@needs_desktop
def test_an_old_opengl_is_too_old(file: Path, tmp_path: Path) -> None:
    with desktop(tmp_path) as screen:
        (said,) = refusals((screen.display, file, ""), MESA_GL_VERSION_OVERRIDE="3.0")
    assert said.startswith("MissingToolError: window: there is no OpenGL 3.3") and "update the graphics driver" in said


@needs_desktop
def test_what_cannot_be_shown_closes_the_window_with_the_reason(file: Path, tmp_path: Path) -> None:
    torn, notes = tmp_path / "torn.amc.ktx2", tmp_path / "notes.txt"
    torn.write_bytes(file.read_bytes()[:300])
    notes.write_text("no material")
    with desktop(tmp_path) as screen:
        first, second, third = refusals(
            (screen.display, torn, ""), (screen.display, notes, ""), (screen.display, file, "teapot")
        )
    assert first.startswith("FormatError") and str(torn) in first
    assert second.startswith("InputError") and "unknown ending" in second
    assert third.startswith("InputError") and "no such mesh" in third
