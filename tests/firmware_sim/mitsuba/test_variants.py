"""The probe runs in a process of its own, so that an abort costs speed and nothing else."""

import sys
from pathlib import Path

import pytest

from firmware_sim.mitsuba.config import MitsubaScene
from firmware_sim.mitsuba.renderer import MitsubaRenderer
from firmware_sim.mitsuba.variants import FAST, PROBE, SAFE, MitsubaMissingError, best_variant, budget, probe_once
from firmware_sim.scene.pose import Pose

pytest.importorskip("mitsuba", reason="mitsuba is not installed; pip install 'litrig[sim]'")

FINE = (sys.executable, "-c", "pass")
ABORTING = (sys.executable, "-c", "import os; os.abort()")
FAILING = (sys.executable, "-c", "raise SystemExit(1)")


@pytest.mark.parametrize(
    ("command", "variant"),
    [
        pytest.param(FINE, FAST, id="it works"),
        pytest.param(ABORTING, SAFE, id="it aborts, as with an old libLLVM"),
        pytest.param(FAILING, SAFE, id="it raises"),
        pytest.param(("/nonexistent/python",), SAFE, id="it does not start"),
    ],
)
def test_the_variant_follows_from_how_the_probe_ends(tmp_path: Path, command: tuple[str, ...], variant: str) -> None:
    assert probe_once(tmp_path, command) == variant


def test_the_answer_is_remembered_for_the_next_process(tmp_path: Path) -> None:
    assert probe_once(tmp_path, ABORTING) == SAFE
    assert probe_once(tmp_path, FINE) == SAFE


def test_another_compiler_library_is_probed_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert probe_once(tmp_path, ABORTING) == SAFE
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/opt/another/libLLVM.so")
    assert probe_once(tmp_path, FINE) == FAST


def test_a_spoilt_cache_is_probed_anew(tmp_path: Path) -> None:
    probe_once(tmp_path, FINE)
    (note,) = tmp_path.iterdir()
    note.write_bytes(b"\xff\xfe")
    assert probe_once(tmp_path, ABORTING) == SAFE


def test_a_cache_that_cannot_be_written_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    assert probe_once(tmp_path / "file", FINE) == FAST


def test_the_variant_that_the_probe_finds_renders(tmp_path: Path) -> None:
    variant = probe_once(tmp_path, PROBE)
    assert MitsubaRenderer(MitsubaScene(samples=1), variant).render(Pose(0, 0, 90, 0), (12, 16)).max() > 0


def test_the_slow_variant_is_given_less_to_do() -> None:
    assert budget(SAFE).side_px < budget(FAST).side_px
    assert budget(SAFE).samples < budget(FAST).samples


def test_a_missing_mitsuba_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.delitem(sys.modules, "mitsuba", raising=False)
    with pytest.raises(MitsubaMissingError, match=r"pip install 'litrig\[sim\]'"):
        best_variant()
