"""Frames that were not lit from where their light is said to be."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from acquisition.cli import capture
from acquisition.consistency import FEWEST_LIGHTS, find_inconsistent, suspects
from litrig.base.capture_folder import layout
from litrig.base.capture_folder.journal import Entry, encode_entry, read_journal
from litrig.base.directions import angle_between_deg

RELIEF = Path(__file__).parents[2] / "examples/captures/relief"
F64 = NDArray[np.float64]


def relief() -> tuple[F64, F64]:
    """Return the lights of the example, and its pictures as `suspects` sees them."""
    from acquisition.consistency import _texels

    frames = [entry for entry in read_journal(RELIEF / layout.JOURNAL) if entry["ev"] == "frame"]
    texels = [_texels(RELIEF, entry["file"]) for entry in frames]
    return np.array([entry["light"] for entry in frames]), np.array([one for one in texels if one is not None])


LIGHTS, PICTURES = relief()


def with_journal(folder: Path, change: Callable[[list[Entry]], None]) -> Path:
    shutil.copytree(RELIEF, folder)
    entries = read_journal(folder / layout.JOURNAL)
    change([entry for entry in entries if entry["ev"] == "frame"])
    (folder / layout.JOURNAL).write_bytes(b"".join(encode_entry(entry) for entry in entries))
    return folder


def exchange(one: int, other: int) -> Callable[[list[Entry]], None]:
    def change(frames: list[Entry]) -> None:
        frames[one]["light"], frames[other]["light"] = frames[other]["light"], frames[one]["light"]

    return change


def test_a_session_whose_lights_are_right_has_no_suspects() -> None:
    assert suspects(RELIEF) == []


@settings(max_examples=40, deadline=None)
@given(st.permutations(range(len(LIGHTS))))
def test_two_lamps_whose_wires_are_exchanged_are_both_found_and_nobody_else(order: list[int]) -> None:
    one, other = order[:2]
    wired = np.arange(len(LIGHTS))
    wired[[one, other]] = other, one
    found = {index: partner for index, _, partner in find_inconsistent(LIGHTS[wired], PICTURES)}
    assert set(found) == {one, other}, f"{angle_between_deg(LIGHTS[one], LIGHTS[other]):.0f}° apart"


@settings(max_examples=20, deadline=None)
@given(st.permutations(range(len(LIGHTS))), st.floats(0.8, 1.2))
def test_a_frame_lit_by_another_lamp_is_found_with_its_direction(order: list[int], power: float) -> None:
    one, other = order[:2]
    apart_deg = angle_between_deg(LIGHTS[one], LIGHTS[other])
    pictures = PICTURES.copy()
    pictures[one] = PICTURES[other] * power
    found = find_inconsistent(LIGHTS, pictures)
    if apart_deg > 30:
        assert [index for index, _, _ in found] == [one]
        assert angle_between_deg(found[0][1], LIGHTS[other]) < 20


def test_three_lamps_in_a_ring_are_all_found() -> None:
    wired = np.arange(len(LIGHTS))
    wired[[2, 9, 17]] = 9, 17, 2
    assert {2, 9, 17} <= {index for index, _, _ in find_inconsistent(LIGHTS[wired], PICTURES)}


def test_a_flat_matte_sample_says_nothing() -> None:
    pictures = np.repeat(LIGHTS[:, 2:], 1200, axis=1)
    pictures += np.random.default_rng(1).normal(0, 0.002, pictures.shape)
    assert find_inconsistent(LIGHTS, pictures) == []


@pytest.mark.parametrize("lights", [LIGHTS[: FEWEST_LIGHTS - 1], np.repeat(LIGHTS[:1], 24, axis=0)])
def test_lights_that_are_few_or_all_the_same_say_nothing(lights: F64) -> None:
    assert find_inconsistent(lights, PICTURES[: len(lights)]) == []


def test_suspects_are_named_by_step_with_the_step_whose_light_they_have(tmp_path: Path) -> None:
    folder = with_journal(tmp_path / "s", exchange(3, 12))
    found = suspects(folder)
    assert [(suspect.step, suspect.exchanged_with) for suspect in found] == [(3, 12), (12, 3)]
    assert "step 3 looks lit from about azimuth" in str(found[0])
    assert "as step 12 should be" in str(found[0])


def test_thumbnails_that_are_gone_are_made_from_the_frames(tmp_path: Path) -> None:
    folder = with_journal(tmp_path / "s", exchange(3, 12))
    shutil.rmtree(folder / layout.THUMBS)
    assert [suspect.step for suspect in suspects(folder)] == [3, 12]


def test_each_pose_of_the_table_is_judged_by_itself(tmp_path: Path) -> None:
    def two_poses(frames: list[Entry]) -> None:
        for index, entry in enumerate(frames):
            entry["pose_goal"]["angle_deg"] = 90.0 * (index % 2)
        exchange(4, 8)(frames)

    folder = with_journal(tmp_path / "s", two_poses)
    assert [(suspect.step, suspect.exchanged_with) for suspect in suspects(folder)] == [(4, 8), (8, 4)]


def test_repeats_of_a_light_are_no_further_lights(tmp_path: Path) -> None:
    def six_lights(frames: list[Entry]) -> None:
        for index, entry in enumerate(frames):
            entry |= {key: frames[index % 6][key] for key in ("light", "pose_goal")}

    assert suspects(with_journal(tmp_path / "s", six_lights)) == []


def test_the_end_of_a_session_warns_in_one_line_and_is_no_failure(tmp_path: Path) -> None:
    folder = with_journal(tmp_path / "s", exchange(3, 12))
    result = CliRunner().invoke(capture, ["resume", str(folder)])
    assert result.exit_code == 0, result.output
    warnings = [line for line in result.stderr.splitlines() if "warning" in line]
    assert len(warnings) == 1
    assert warnings[0].startswith(f"litrig: {folder}: warning: step 3 looks lit from")
    assert "and 1 more; check lamps and cables" in warnings[0]
    assert "warning" not in CliRunner().invoke(capture, ["resume", str(RELIEF)]).stderr
