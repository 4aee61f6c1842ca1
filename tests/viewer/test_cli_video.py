"""Every frame of a video is the still picture of its moment."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from click import UsageError

import viewer.render_file
import viewer.render_flat
from litrig.base.errors import InputError
from processing.amc.files.ktx2 import write_amc
from processing.ptm.basis import PTM
from processing.ptm.files.either import write_any
from tests.processing.ptm.files.fitted import fitted
from tests.viewer.scenes import KEY, lit_and_unlit
from tests.viewer.test_cli import SMALL, codes, run

KEYED = ["--unlit", "x.unlit.amc.ktx2", "--key", *map(str, KEY)]


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, amc in zip(("x.amc.ktx2", "x.unlit.amc.ktx2"), lit_and_unlit(16, 8), strict=True):
        write_amc(tmp_path / name, amc)
    write_any(tmp_path / "x.ptm", fitted(PTM, "lrgb"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def frames(monkeypatch: pytest.MonkeyPatch) -> list[np.ndarray]:
    """What goes to the encoder, for an encoder loses a little."""
    kept: list[np.ndarray] = []

    def keep(_path: Path, given: Iterable[np.ndarray], size: tuple[int, int], fps: float) -> None:
        kept.extend(given)
        assert {frame.shape for frame in kept} == {(size[1], size[0], 3)}
        assert fps == 25

    monkeypatch.setattr(viewer.render_file, "write_video", keep)
    monkeypatch.setattr(viewer.render_flat, "write_video", keep)
    return kept


@pytest.mark.parametrize(
    "arguments",
    [
        pytest.param(["x.amc.ktx2", "--mesh", "ribbon", *SMALL, *KEYED], id="a key light's shadow moves too"),
        pytest.param(["x.amc.ktx2", "--mesh", "ribbon", *SMALL, "--tangents"], id="tangents"),
        pytest.param(["x.ptm", "--mesh", "ribbon", *SMALL, "--exposure", "1", "--tone", "reinhard"], id="tone"),
        pytest.param(["x.ptm", "--mesh", "ribbon", *SMALL, "--beside", "x.amc.ktx2"], id="beside"),
    ],
)
def test_on_a_turntable(files: Path, frames: list[np.ndarray], arguments: list[str]) -> None:
    told = run(*arguments, "-o", "x.mp4", "--turntable", 3, "--yaw", 10)
    assert told.endswith(" × 40 pixels, 3 frames\n")
    for frame, yaw_deg in zip(frames, (10, 130, 250), strict=True):
        run(*arguments, "-o", "still.png", "--yaw", yaw_deg)
        np.testing.assert_array_equal(frame, codes(files / "still.png"))
    assert np.abs(frames[0].astype(int) - frames[1]).max() > 30


@pytest.mark.parametrize("where", [[], ["--mesh", "ribbon", *SMALL]], ids=["flat", "mesh"])
@pytest.mark.parametrize("extra", [[], ["--specular", "0.3", "20", "--diffuse-gain", "1.5"], ["--exposure", "-1"]],
                         ids=" ".join)  # fmt: skip
def test_on_a_tour_of_the_light(files: Path, frames: list[np.ndarray], where: list[str], extra: list[str]) -> None:
    run("x.ptm", "-o", "x.mp4", "--tour", 4, "--light", 0.6, 0, *where, *extra)
    for frame, light in zip(frames, ((0.6, 0), (0, 0.6), (-0.6, 0), (0, -0.6)), strict=True):
        run("x.ptm", "-o", "still.png", "--light", *light, *where, *extra)
        assert np.abs(frame.astype(int) - codes(files / "still.png")).max() <= 1
    assert np.abs(frames[0].astype(int) - frames[1]).max() > 30


def test_what_has_its_light_in_it_goes_on_no_tour(files: Path) -> None:
    with pytest.raises(InputError, match="was lit when it was captured; leave out the light, turn the object instead"):
        run("x.amc.ktx2", "-o", "x.mp4", "--tour", 4)
    assert not (files / "x.mp4").exists()


def test_two_courses_and_a_still_picture_s_speed_are_wrong_usage(files: Path) -> None:
    with pytest.raises(UsageError, match="two videos; give one"):
        run("x.ptm", "-o", "x.mp4", "--tour", 4, "--turntable", 4)
    with pytest.raises(UsageError, match="the speed of a video"):
        run("x.ptm", "-o", "x.png", "--fps", 30)
