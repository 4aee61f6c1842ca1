"""A session on the simulated rig, seen through mitsuba: its frames are rendered ahead, and become a material."""

from pathlib import Path

import pytest

from tests.system.command import litrig

pytest.importorskip("mitsuba", reason="needs the extra sim", exc_type=ImportError)

SIM = """
[camera]
width = 320
height = 240
[scene]
kind = "mitsuba"
sample = "brushed-metal"
samples = 4
"""


def test_a_plan_is_rendered_ahead_and_becomes_a_material(tmp_path: Path) -> None:
    (tmp_path / "sim.toml").write_text(SIM)
    script = f'litrig capture amc "$LITRIG_RIG" -o {tmp_path}/s --slices 16'
    result = litrig("sim", "run", tmp_path / "sim.toml", "--", "sh", "-c", script)
    assert result.returncode == 0, result.stderr
    assert "frames: 16/16" in result.stderr
    built = litrig("amc", "build", tmp_path / "s", "-o", tmp_path / "x.amc.ktx2", "--size", "48")
    assert built.returncode == 0, built.stderr
    assert "R = 2" in built.stdout.splitlines()
