"""What differs between two sessions."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from acquisition.cli import capture
from acquisition.compare.comparison import compare
from acquisition.compare.lines import lines_of
from acquisition.compare.matching import Tolerances, match
from acquisition.plans import Aim, Step, ptm_plan
from litrig.base.capture_folder.capture import Role
from tests.acquisition.report.sessions import SETTINGS, Written, turn

EIGHT = turn(8)


def session(
    folder: Path, steps: list[Step] = EIGHT, settings: dict[str, Any] | None = None, level: int = 120, **fields: Any
) -> Path:
    with Written(folder, steps, settings) as written:
        for step in steps:
            written.shoot(step, level, **fields)
        written.close()
    return folder


def with_rig(**sections: Any) -> dict[str, Any]:
    return {**SETTINGS, "rig": {**SETTINGS["rig"], **sections}}


def test_a_session_differs_in_nothing_from_itself(tmp_path: Path) -> None:
    folder = session(tmp_path / "a")
    lines = lines_of(compare(folder, folder))
    assert [line.split()[-2:] for line in lines[2:4]] == [["the", "same"]] * 2
    assert lines[-1] == "versions     the same"
    assert "median +0.0000, worst +0.0000 (step 0)" in lines[4]


def test_settings_are_named_by_key_and_device_paths_do_not_count(tmp_path: Path) -> None:
    lamps = {"lamp": [{"gain": 1.0}, {"gain": 0.5}]}
    a = with_rig(camera={"device": "/dev/video0", "gain": 0, "serial_number": ""}, lights=lamps)
    b = with_rig(camera={"device": "/dev/video7", "gain": 3}, lights={"lamp": [{"gain": 1.0}, {"gain": 0.6}]})
    del b["rig"]["arm"]
    found = compare(session(tmp_path / "a", settings=a), session(tmp_path / "b", settings=b))
    assert [(setting.key, setting.a, setting.b) for setting in found.settings] == [
        ("rig.arm", {"tolerance_deg": 0.2}, None),
        ("rig.camera.gain", 0, 3),
        ("rig.lights.lamp[1].gain", 0.5, 0.6),
    ]
    assert any(line.endswith("rig.camera.gain          0 → 3") for line in lines_of(found))


def test_the_same_poses_in_another_order_are_the_same_steps(tmp_path: Path) -> None:
    steps = list(ptm_plan(12))
    other = [replace(step, step=index) for index, step in enumerate(reversed(steps))]
    found = compare(session(tmp_path / "a", steps), session(tmp_path / "b", other))
    assert len(found.plan.same) == 12
    assert (found.plan.moved, found.plan.only_a, found.plan.only_b) == ((), (), ())
    assert "12 steps of one pose, 12 of them under another number" in "\n".join(lines_of(found))


def test_steps_elsewhere_and_steps_of_one_session_alone_are_named(tmp_path: Path) -> None:
    moved = [replace(EIGHT[0], angle_deg=0.2), replace(EIGHT[1], angle_deg=46.0), *EIGHT[2:7]]
    closure = Step(9, Role.CLOSURE, angle_deg=360.0)
    found = compare(session(tmp_path / "a"), session(tmp_path / "b", [*moved, closure]))
    assert len(found.plan.same) == 6
    assert [(one.step, other.step, turned, lit) for one, other, turned, lit in found.plan.moved] == [(1, 1, 1.0, 0.0)]
    assert ([step.step for step in found.plan.only_a], [step.step for step in found.plan.only_b]) == ([7], [9])
    text = "\n".join(lines_of(found))
    assert "1 step elsewhere, at most 1.00° (step 1)" in text
    assert "1 only in B: 9 (closure 360°)" in text


def test_exposures_are_compared_step_by_step(tmp_path: Path) -> None:
    a = session(tmp_path / "a", level=100, camera={"exposure_ms": 10.0, "gain": 0})
    with Written(tmp_path / "b", EIGHT) as written:
        for step in EIGHT:
            level = 200 if step.step == 3 else 110
            clipped = 0.25 if step.step == 3 else 0.0
            checks = {"mean": level / 255, "clipped": clipped, "sharpness": 0.02 - 0.002 * step.step}
            written.shoot(step, level, camera={"exposure_ms": 20.0, "gain": 0}, checks=checks)
    found = compare(a, tmp_path / "b")
    assert [(one.key, one.a, one.b, one.steps) for one in found.camera] == [("exposure_ms", 10.0, 20.0, 8)]
    figures = {measure.name: measure for measure in found.measures}
    assert figures["mean"].median == pytest.approx(10 / 255)
    assert figures["mean"].worst == pytest.approx(100 / 255)
    assert figures["mean"].worst_step == 3
    assert (figures["clipped"].median, figures["clipped"].worst, figures["clipped"].worst_step) == (0, 0.25, 3)
    assert figures["sharpness"].kind == "ratio"
    assert figures["sharpness"].worst == pytest.approx(2.0)


def test_instruments_and_versions_of_all_segments_count(tmp_path: Path) -> None:
    a = session(tmp_path / "a")
    settings = {**SETTINGS, "instruments": ["turntable XL430-W250, serial number 18"]}
    with Written(tmp_path / "b", EIGHT, settings) as written:
        written.writer.record("segment", number=2, litrig="0.2.0")
    found = compare(a, tmp_path / "b")
    assert [devices[0][-2:] for devices in found.instruments] == ["17", "18"]
    assert found.versions == (("0.1.0",), ("0.1.0", "0.2.0"))
    assert "exposure     no step of one pose was shot in both" in lines_of(found)


def test_the_command_ends_well_whether_or_not_anything_differs(tmp_path: Path) -> None:
    a, b = session(tmp_path / "a"), session(tmp_path / "b", EIGHT[:7])
    result = CliRunner().invoke(capture, ["diff", str(a), str(b), "--json"])
    assert result.exit_code == 0
    told = json.loads(result.stdout)
    assert told["plan"] == {"same": 7, "renumbered": 0, "moved": [], "only_a": [7], "only_b": []}
    assert set(told["measures"]) == {"mean", "clipped", "sharpness", "turntable"}
    assert CliRunner().invoke(capture, ["diff", str(a), str(tmp_path)]).exit_code == 1


poses = st.builds(
    Step,
    step=st.integers(0, 30),
    role=st.sampled_from([Role.FRAME, Role.CLOSURE]),
    angle_deg=st.none() | st.integers(0, 4).map(lambda turn: 90.0 * turn),
    aim=st.none() | st.builds(Aim, st.integers(0, 3).map(lambda turn: 90.0 * turn), st.sampled_from([30.0, 60.0])),
)
plans = st.lists(poses, max_size=20, unique_by=lambda step: step.step)


@given(plans, plans)
def test_every_step_is_in_exactly_one_place(a: list[Step], b: list[Step]) -> None:
    found = match(a, b, Tolerances())
    pairs = [*found.same, *((one, other) for one, other, _, _ in found.moved)]
    for plan, paired, alone in ((a, 0, found.only_a), (b, 1, found.only_b)):
        placed = [pair[paired] for pair in pairs] + list(alone)
        assert sorted(step.step for step in placed) == sorted(step.step for step in plan)
    assert all(pose(one) == pose(other) for one, other in found.same)
    assert not {pose(step) for step in found.only_a} & {pose(step) for step in found.only_b}


def pose(step: Step) -> object:
    return (step.role, step.angle_deg, step.aim)
